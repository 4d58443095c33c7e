#pragma once

#include <string_view>
#include <vector>

#include "io/formats/common/buffered_input.h"
#include "io/formats/ply/header.h"

// The body of a PLY file: words and bytes to values.
namespace lucarne::io::ply {

/// The next `bytes` bytes, which have to be there.
Result<const std::byte*> take(BufferedInput& input, size_t bytes);
/// One binary entry with lists. The scalars are appended to `packed` where it is wanted.
Result<void> walk_entry(BufferedInput& input, const Element& element, bool big_endian, std::byte* packed);
/// The next line that is not blank, for this entry.
Result<std::string_view> text_line(BufferedInput& input, const Header& header, const Element& element,
                                   uint64_t number);
Result<void> skip_element(BufferedInput& input, const Header& header, const Element& element);
/// Parses `word` into `at`. A "char" takes 128 to 255 as well: some writers mean uchar.
bool parse_scalar(ScalarType type, std::string_view word, std::byte* at);

/// The values of one entry, in the order of its properties: those of property i are [begin[i], begin[i + 1]).
struct Entry {
    std::vector<double> values;
    std::vector<size_t> begin;
    std::span<const double> of(size_t property) const {
        return std::span(values).subspan(begin[property], begin[property + 1] - begin[property]);
    }
};
/// A list of more values is rejected.
inline constexpr uint64_t kMostListed = uint64_t{1} << 20;
/// The error of an entry, numbered from 1, that the end of the file cuts off.
tl::unexpected<Error> ends_early(const BufferedInput& input, const Element& element, uint64_t number);
/// The error of a word that is no value of `property`; where the file ends with its line it is cut off.
tl::unexpected<Error> bad_word(const BufferedInput& input, const Element& element, uint64_t number,
                               std::string_view property, std::string_view word);
/// Reads the next entry; `number`, from 1, is for the message.
Result<void> read_entry(BufferedInput& input, const Header& header, const Element& element, uint64_t number,
                        Entry& entry);

/// What becomes of an entry where a damaged file is to be saved.
enum class Fate { kept, lost, rest_lost };
/// Of the entry of one of the header's elements that was read from `begin` on; `left`: with those behind it.
/// Without `salvage` what is wrong with it is an error.
Result<Fate> fate_of(Result<void> done, const BufferedInput& input, const Header& header,
                     const Element& element, uint64_t begin, uint64_t left, bool salvage);

}  // namespace lucarne::io::ply
