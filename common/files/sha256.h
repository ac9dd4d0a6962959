#pragma once
// SHA-256 (FIPS 180-4), by OpenSSL.
#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace rayfarm {

/// The sum of bytes that come piece by piece. Throws IoError where OpenSSL has none.
class Sha256 {
 public:
  Sha256();
  void update(std::span<const std::byte> bytes);
  /// Of all bytes, in hexadecimal: the last that is asked.
  std::string digest();

 private:
  struct Free {
    void operator()(void* context) const;
  };
  std::unique_ptr<void, Free> context_;  ///< OpenSSL's, whose header who includes this need not have
};

/// SHA-256 of the bytes in hexadecimal.
std::string sha256(std::span<const std::byte> bytes);

}  // namespace rayfarm
