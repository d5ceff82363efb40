#pragma once
/// Text files that a user wrote or exported, and the numbers in them: one strict rule for every reader.

#include <string>
#include <string_view>
#include <vector>

namespace snapwing::common {

/// A decimal number that fills the whole text: digits with at most one point, perhaps a sign and an exponent. No
/// blanks, no decimal comma, no unit, no hexadecimal, no `inf` or `nan`. Values too small for a double are 0.
/// @return false, and `value` untouched, if the text is anything else or too large for a double
bool parseNumber(std::string_view text, double* value);
/// The same without point and exponent. @return false if it is none or outside of an int
bool parseInteger(std::string_view text, int* value);
/// True for digits that begin with a 0 that means nothing: 010 is 8 to one reader and 10 to another.
bool hasLeadingZero(std::string_view text);

/// Text of six significant digits, or of as many as it takes to read back as the same number, so that no message rounds
/// a value into its allowed range.
std::string toText(double value);

/// Text with one kind of line end, \n, whatever ends its lines (CR LF, CR), and without the mark of UTF-8.
/// @throws FileError for UTF-16, UTF-32 and bytes of zero, which no text file in UTF-8 has
std::string plainText(const std::string& bytes, const std::string& path);
/// @throws FileError also if it cannot be read
std::string readTextFile(const std::string& path);

/// One line of a table: its number in the file, counted from 1, and its fields without blanks around.
struct TextRow {
  int line = 0;
  std::string text;
  std::vector<std::string> fields;
};
/// Lines of a file of comma separated values that are neither empty nor begin with #. Double quotes around a field are
/// taken off; a comma within them does not part fields.
std::vector<TextRow> readCsv(const std::string& path);

}  // namespace snapwing::common
