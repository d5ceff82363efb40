#pragma once
/// Strict parsing of text files that a user wrote or exported, and of the numbers in them.

#include <string>
#include <string_view>
#include <vector>

namespace snapwing::common {

/// Parses a decimal number that is the whole text: digits with at most one point, an optional sign and exponent. No
/// blanks, no decimal comma, no unit, no hexadecimal, no `inf` or `nan`. Values too small for a double are 0.
/// @return false, and `value` unchanged, for other text or a number too large for a double
bool parseNumber(std::string_view text, double* value);
/// Likewise without point and exponent. @return false for other text or a number outside the range of int
bool parseInteger(std::string_view text, int* value);
/// True for digits with a leading zero, which is ambiguous: some readers take 010 for 8.
bool hasLeadingZero(std::string_view text);

/// The number with at least six significant digits, and as many as are needed to read back the same number, so that no
/// message rounds a value into its allowed range.
std::string toText(double value);

/// The text with line ends (CR LF, CR) converted to \n, without a UTF-8 byte order mark.
/// @param path  for messages. @throws FileError for UTF-16, UTF-32 and zero bytes
std::string plainText(const std::string& bytes, const std::string& path);
/// plainText of a file. @throws FileError, also if it cannot be read
std::string readTextFile(const std::string& path);

/// One line of a table: its number in the file, from 1, its text, and its fields without surrounding blanks.
struct TextRow {
  int line = 0;
  std::string text;
  std::vector<std::string> fields;
};
/// Lines of a CSV file that are neither empty nor start with #. Double quotes around a field are removed; a comma
/// within them is part of the field. @throws FileError
std::vector<TextRow> readCsv(const std::string& path);

}  // namespace snapwing::common
