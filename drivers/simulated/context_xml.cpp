#include <string>
#include <string_view>

#include "drivers/simulated/number_text.hpp"
#include "drivers/simulated/simulated_adc.hpp"

namespace kolsky {

namespace {

// libiio validates nothing against it, but other readers of the protocol may.
constexpr const char* kHead =
    R"(<?xml version="1.0" encoding="utf-8"?><!DOCTYPE context [)"
    R"(<!ELEMENT context (device | context-attribute)*>)"
    R"(<!ELEMENT context-attribute EMPTY>)"
    R"(<!ELEMENT device (channel | attribute | debug-attribute | buffer-attribute)*>)"
    R"(<!ELEMENT channel (scan-element?, attribute*)>)"
    R"(<!ELEMENT attribute EMPTY><!ELEMENT scan-element EMPTY>)"
    R"(<!ELEMENT debug-attribute EMPTY><!ELEMENT buffer-attribute EMPTY>)"
    R"(<!ATTLIST context name CDATA #REQUIRED version-major CDATA #REQUIRED )"
    R"(version-minor CDATA #REQUIRED version-git CDATA #REQUIRED description CDATA #IMPLIED>)"
    R"(<!ATTLIST context-attribute name CDATA #REQUIRED value CDATA #REQUIRED>)"
    R"(<!ATTLIST device id CDATA #REQUIRED name CDATA #IMPLIED label CDATA #IMPLIED>)"
    R"(<!ATTLIST channel id CDATA #REQUIRED type (input|output) #REQUIRED name CDATA #IMPLIED>)"
    R"(<!ATTLIST scan-element index CDATA #REQUIRED format CDATA #REQUIRED scale CDATA #IMPLIED>)"
    R"(<!ATTLIST attribute name CDATA #REQUIRED filename CDATA #IMPLIED>)"
    R"(<!ATTLIST debug-attribute name CDATA #REQUIRED>)"
    R"(<!ATTLIST buffer-attribute name CDATA #REQUIRED>]>)";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string voltage_channel(std::size_t index, int bits, const AdcChannel& channel) {
  const std::string id = "voltage" + std::to_string(index);
  std::string xml = R"(<channel id=")" + id + R"(" type="input"><scan-element index=")" +
                    std::to_string(index) + R"(" format="le:s)" + std::to_string(bits) +
                    (bits <= 16 ? "/16" : "/32") + R"(&gt;&gt;0" scale=")" +
                    number_text(channel.scale_mV) + R"("/>)";
  for (const char* name : {"label", "offset", "raw", "scale", "strain_scale"}) {
    if (!channel.strain_scale && std::string_view(name) == "strain_scale") {
      continue;
    }
    xml += std::string(R"(<attribute name=")") + name + R"(" filename="in_)" + id + "_" + name +
           R"("/>)";
  }
  return xml + "</channel>";
}

std::string counter_channel(std::size_t index) {
  return R"(<channel id="count0" type="input"><scan-element index=")" + std::to_string(index) +
         R"(" format="le:u32/32&gt;&gt;0"/><attribute name="raw" filename="in_count0_raw"/></channel>)";
}

}  // namespace

std::string SimulatedAdc::context_xml() const {
  std::string xml = kHead;
  xml +=
      R"(<context name="kolsky-digitiser" version-major="0" version-minor="24" version-git="v0.24" )"
      R"(description="Kolsky simulated digitiser, scenario )" +
      escaped(settings_.scenario) + R"("><device id="iio:device0" name="kolsky-adc">)";
  for (std::size_t i = 0; i < settings_.channels.size(); ++i) {
    xml += voltage_channel(i, settings_.bits, settings_.channels[i]);
  }
  if (settings_.counter) {
    xml += counter_channel(settings_.channels.size());
  }
  for (const char* name :
       {"fire", "injected_lost_samples", "overrun_lost_samples", "sampling_frequency",
        "sampling_frequency_available", "scenario", "seed", "shots_fired", "speed"}) {
    xml += std::string(R"(<attribute name=")") + name + R"("/>)";
  }
  return xml + R"(<debug-attribute name="direct_reg_access"/></device></context>)";
}

}  // namespace kolsky
