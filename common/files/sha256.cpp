#include "common/files/sha256.h"

#include <openssl/evp.h>

#include "common/errors/input_error.h"

namespace rayfarm {
namespace {

EVP_MD_CTX* evp_of(void* context) {
  return static_cast<EVP_MD_CTX*>(context);
}

void require(bool is_done) {
  if (!is_done) throw IoError("SHA-256 is not available");
}

}  // namespace

void Sha256::Free::operator()(void* context) const {
  EVP_MD_CTX_free(evp_of(context));
}

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  require(context_ && EVP_DigestInit_ex(evp_of(context_.get()), EVP_sha256(), nullptr) == 1);
}

void Sha256::update(std::span<const std::byte> bytes) {
  require(EVP_DigestUpdate(evp_of(context_.get()), bytes.data(), bytes.size()) == 1);
}

std::string Sha256::digest() {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  require(EVP_DigestFinal_ex(evp_of(context_.get()), digest, &size) == 1);
  std::string text;
  for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

std::string sha256(std::span<const std::byte> bytes) {
  Sha256 sum;
  sum.update(bytes);
  return sum.digest();
}

}  // namespace rayfarm
