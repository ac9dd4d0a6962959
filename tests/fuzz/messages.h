#pragma once
// Messages of the net, whole and damaged.
#include <string>
#include <vector>

namespace rayfarm::fuzz {

std::vector<std::string> message_seeds();

/// Every decoder of messages: any of them may meet any bytes.
void decode_messages(const std::string& text);

}  // namespace rayfarm::fuzz
