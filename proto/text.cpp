#include "proto/text.hpp"

#include <google/protobuf/message.h>

#include <boost/locale/utf.hpp>
#include <memory>
#include <vector>

namespace kolsky::wire {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
namespace utf = boost::locale::utf;

/// Steps over one character. @return whether it is one
bool step(const char*& at, const char* end) {
  const utf::code_point point = utf::utf_traits<char>::decode(at, end);
  return point != utf::illegal && point != utf::incomplete;
}

bool is_utf8(const std::string& text) {
  const char* at = text.data();
  const char* const end = at + text.size();
  bool valid = true;
  while (valid && at != end) {
    valid = step(at, end);
  }
  return valid;
}

std::string repaired(const std::string& text) {
  std::string valid;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    const char* const start = at;
    if (step(at, end)) {
      valid.append(start, at);
    } else {
      valid += '?';
      at = start + 1;
    }
  }
  return valid;
}

std::vector<const FieldDescriptor*> fields_of(const Message& message) {
  std::vector<const FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  return fields;
}

bool is_text(const FieldDescriptor& field) {
  return field.type() == FieldDescriptor::TYPE_STRING;
}
bool is_message(const FieldDescriptor& field) {
  return field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
}

int count(const Message& message, const FieldDescriptor& field) {
  return field.is_repeated() ? message.GetReflection()->FieldSize(message, &field) : 1;
}

std::string text_of(const Message& message, const FieldDescriptor& field, int index) {
  const Reflection& reflection = *message.GetReflection();
  return field.is_repeated() ? reflection.GetRepeatedString(message, &field, index)
                             : reflection.GetString(message, &field);
}

const Message& part_of(const Message& message, const FieldDescriptor& field, int index) {
  const Reflection& reflection = *message.GetReflection();
  return field.is_repeated() ? reflection.GetRepeatedMessage(message, &field, index)
                             : reflection.GetMessage(message, &field);
}

bool is_valid(const Message& message) {
  for (const FieldDescriptor* field : fields_of(message)) {
    for (int i = 0; i < count(message, *field); ++i) {
      if (is_text(*field)) {
        if (!is_utf8(text_of(message, *field, i))) {
          return false;
        }
      } else if (is_message(*field) && !is_valid(part_of(message, *field, i))) {
        return false;
      }
    }
  }
  return true;
}

void repair(Message& message) {
  const Reflection& reflection = *message.GetReflection();
  for (const FieldDescriptor* field : fields_of(message)) {
    for (int i = 0; i < count(message, *field); ++i) {
      if (is_text(*field)) {
        std::string text = repaired(text_of(message, *field, i));
        field->is_repeated() ? reflection.SetRepeatedString(&message, field, i, std::move(text))
                             : reflection.SetString(&message, field, std::move(text));
      } else if (is_message(*field)) {
        repair(field->is_repeated() ? *reflection.MutableRepeatedMessage(&message, field, i)
                                    : *reflection.MutableMessage(&message, field));
      }
    }
  }
}

}  // namespace

std::string serialise(const Message& message) {
  if (is_valid(message)) {
    return message.SerializeAsString();
  }
  const std::unique_ptr<Message> copy(message.New());
  copy->CopyFrom(message);
  repair(*copy);
  return copy->SerializeAsString();
}

}  // namespace kolsky::wire
