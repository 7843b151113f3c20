#pragma once
// What can go wrong between two processes. Each error names the other side, what was awaited, and the step.

#include <cstdint>
#include <stdexcept>
#include <string>

namespace gabion::protocol {

struct WireError : std::runtime_error {
  WireError(std::string peer_, std::string awaited_, std::uint64_t step_, const std::string& what_happened)
      : std::runtime_error(peer_ + ": " + what_happened + " (" + awaited_ + ", step " + std::to_string(step_) + ")"),
        peer(std::move(peer_)),
        awaited(std::move(awaited_)),
        step(step_) {}
  std::string peer;     ///< name and address of the other side
  std::string awaited;  ///< "waiting for GAP", "sending RUN"
  std::uint64_t step;   ///< step that this side was at
};

/// The other side closed the connection, was killed, or could never be reached.
struct ConnectionLost : WireError {
  using WireError::WireError;
};
/// The other side is connected but did not answer in time.
struct Timeout : WireError {
  using WireError::WireError;
};
/// The other side sent what the protocol does not allow here.
struct ProtocolError : WireError {
  using WireError::WireError;
};
/// A sound frame, but not the message that is due here; the connection can go on.
struct UnexpectedMessage : ProtocolError {
  using ProtocolError::ProtocolError;
};
/// The message that is due, with content that does not fit; the connection can go on.
struct BadMessage : ProtocolError {
  using ProtocolError::ProtocolError;
};
/// The other side speaks another version.
struct VersionMismatch : ProtocolError {
  using ProtocolError::ProtocolError;
};

/// The other side answered with an ERROR message.
struct RemoteError : WireError {
  RemoteError(std::string peer_, std::string awaited_, std::uint64_t step_, std::string code_, std::string message_,
              std::string where_, std::string advice_)
      : WireError(std::move(peer_), std::move(awaited_), step_,
                  code_ + " error: " + message_ + (where_.empty() ? "" : " [" + where_ + "]") +
                      (advice_.empty() ? "" : "; " + advice_)),
        code(std::move(code_)),
        message(std::move(message_)),
        where(std::move(where_)),
        advice(std::move(advice_)) {}
  std::string code, message, where, advice;  ///< fields of ERROR; WireError::step is that of the message
};

/// The address cannot be listened on or is no address; a mistake of the user.
struct AddressError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace gabion::protocol
