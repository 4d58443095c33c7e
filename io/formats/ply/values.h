#pragma once

#include <string_view>
#include <vector>

#include "io/formats/common/buffered_input.h"
#include "io/formats/ply/header.h"

// Converts the body of a PLY file, words or bytes, to values.
namespace lucarne::io::ply {

/// Takes the next `bytes` bytes; fewer is an error.
Result<const std::byte*> take(BufferedInput& input, size_t bytes);
/// Reads one binary entry with lists. Appends the scalars to `packed` unless that is null.
Result<void> walk_entry(BufferedInput& input, const Element& element, bool big_endian, std::byte* packed);
/// Returns the next line that is not blank, for this entry.
Result<std::string_view> text_line(BufferedInput& input, const Header& header, const Element& element,
                                   uint64_t number);
Result<void> skip_element(BufferedInput& input, const Header& header, const Element& element);
/// Parses `word` into `at`. A "char" may also be 128 to 255, because some writers mean uchar.
bool parse_scalar(ScalarType type, std::string_view word, std::byte* at);

/// The values of one entry in the order of its properties. Those of property i are [begin[i], begin[i + 1]).
struct Entry {
    std::vector<double> values;
    std::vector<size_t> begin;
    std::span<const double> of(size_t property) const {
        return std::span(values).subspan(begin[property], begin[property + 1] - begin[property]);
    }
};
/// A list with more values is rejected.
inline constexpr uint64_t kMostListed = uint64_t{1} << 20;
/// Returns the error for an entry (numbered from 1) that the end of the file cuts off.
tl::unexpected<Error> ends_early(const BufferedInput& input, const Element& element, uint64_t number);
/// Returns the error for a word that is no value of `property`. If the file ends with its line, the entry
/// counts as cut off.
tl::unexpected<Error> bad_word(const BufferedInput& input, const Element& element, uint64_t number,
                               std::string_view property, std::string_view word);
/// Reads the next entry. `number` (from 1) is for the error message.
Result<void> read_entry(BufferedInput& input, const Header& header, const Element& element, uint64_t number,
                        Entry& entry);

/// What happens to an entry of a damaged file that is being salvaged.
enum class Fate { kept, lost, rest_lost };
/// Returns the fate of an entry that was read from `begin` on. `left` counts this entry and those after it.
/// Without `salvage` an error in `done` is returned as an error.
Result<Fate> fate_of(Result<void> done, const BufferedInput& input, const Header& header,
                     const Element& element, uint64_t begin, uint64_t left, bool salvage);

}  // namespace lucarne::io::ply
