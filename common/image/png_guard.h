#pragma once
// libpng ends what it can't do by a jump; here that becomes an exception.
#include <png.h>

#include <csetjmp>
#include <stdexcept>
#include <string>

namespace rayfarm {

/// What libpng calls when it fails, with the message's place as its pointer; it must not return.
[[noreturn]] inline void keep_png_message(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}
/// Warnings.
inline void ignore_png_message(png_structp, png_const_charp) {}

/// Calls `work`, which libpng may jump out of: nothing in it may need destruction.
template <typename Work>
void png_guarded(png_structp png, const std::string& message, Work work) {
  if (setjmp(png_jmpbuf(png))) throw std::runtime_error(message);
  work();
}

/// Damage is an error wherever it is: nothing is put right in silence.
inline void refuse_png_damage(png_structp png) {
  png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
  png_set_benign_errors(png, 0);
}

}  // namespace rayfarm
