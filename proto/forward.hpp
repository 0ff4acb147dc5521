#pragma once

// Names of the messages, for headers: whoever fills or reads one includes "kolsky/v1/kolsky.pb.h"
// (3 s to compile) in its .cpp.
namespace google::protobuf {
class MessageLite;
}

namespace kolsky::v1 {
class Comparison;
class ControlReply;
class ControlRequest;
class Diagnose;
class Diagnosis;
class Envelope;
class Fault;
class GapInfo;
class Preflight;
class Preview;
class Quality;
class Result;
class Shot;
class ShotAndResult;
class ShotList;
class Snapshot;
class Status;
class TriggerInfo;
}  // namespace kolsky::v1
