// The words of a command, and the files that decide what it computes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// Splits at blanks and handles both kinds of quotes and backslashes as a shell does. Expands
// nothing. Throws Error{usage} if a quote is not closed or there is no word; its message says what
// the command is: `kind` is "optimizer" or "problem".
std::vector<std::string> split_command(std::string_view command, std::string_view kind);

// Returns whether the word is the name of a program that runs scripts, as "python3".
bool is_interpreter(std::string_view word);
// Returns what to name in place of a command or a script of the user: "exec:python3 mine.py" for
// "python3 mine.py", "mine.py", "./mine.py" and "python3". Returns an empty text for a text that
// looks like neither.
std::string suggest_exec(std::string_view text);
// Returns the message for such a text in place of the name of an optimizer or a problem: "unknown
// optimizer 'mine.py'; a program of your own needs exec: before its command, as in --optimizer
// "exec:python3 mine.py"". `flag` is "--optimizer " or, for an argument without a flag, empty.
std::string describe_missing_exec(std::string_view kind, std::string_view text,
                                  std::string_view flag);

// Returns the words of a command that are files, which decide what the program does: the program
// and its script. Starts nothing. Throws Error{usage} if the command cannot be split.
std::vector<std::string> list_program_files(std::string_view command);

// Returns the SHA-256 of a file that decides what a program, a command or a library computes. Throws
// Error if it cannot be read or has more than 1 GiB.
std::string calc_program_hash(const std::filesystem::path& file);

}  // namespace armwright
