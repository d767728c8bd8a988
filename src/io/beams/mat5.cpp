#include "io/beams/mat5.hpp"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <memory>
#include <utility>

#include "io/bytes/text.hpp"

namespace pingvox::mat5 {
namespace {

// Data element types.
enum : std::uint32_t {
  kInt8 = 1,
  kUint8 = 2,
  kInt16 = 3,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kSingle = 7,
  kDouble = 9,
  kInt64 = 12,
  kUint64 = 13,
  kMatrix = 14,
  kCompressed = 15,
};

// Classes of matrices: those from kFirstNumericClass to kLastNumericClass hold numbers.
constexpr std::uint32_t kStructClass = 2;
constexpr std::uint32_t kFirstNumericClass = 6;
constexpr std::uint32_t kLastNumericClass = 15;
constexpr std::uint32_t kComplexFlag = 0x0800;

constexpr std::size_t kHeaderBytes = 128;
constexpr std::size_t kTagBytes = 8;
constexpr std::size_t kMaxFields = 1024;

// Maximum ratio of inflated data to the file, against decompression bombs. A recording of a tank has 2.2; one of
// silence has some hundred but is small.
constexpr std::uint64_t kMaxInflation = 64;
constexpr std::uint64_t kAlwaysInflated = std::uint64_t{16} << 20;

/// Size of a number; 0: not a numeric type.
std::size_t bytes_of(std::uint32_t type) {
  switch (type) {
    case kInt8:
    case kUint8:
      return 1;
    case kInt16:
    case kUint16:
      return 2;
    case kInt32:
    case kUint32:
    case kSingle:
      return 4;
    case kDouble:
    case kInt64:
    case kUint64:
      return 8;
    default:
      return 0;
  }
}

struct Element {
  std::uint32_t type = 0;
  std::span<const std::uint8_t> data;
};

/// The next data element; nullopt when it is longer than the rest.
std::optional<Element> take_element(ByteReader& reader) {
  const auto first = reader.read<std::uint32_t>();
  if (!first) return std::nullopt;
  // Small elements of up to four bytes are stored in the tag.
  if (const std::uint32_t small_count = *first >> 16; small_count != 0) {
    const auto data = reader.take(4);
    if (!data || small_count > 4) return std::nullopt;
    return Element{*first & 0xffff, data->first(small_count)};
  }
  const auto count = reader.read<std::uint32_t>();
  if (!count) return std::nullopt;
  const auto data = reader.take(*count);
  if (!data) return std::nullopt;
  if (*first != kCompressed) reader.take(std::min<std::size_t>((8 - data->size() % 8) % 8, reader.left()));
  return Element{*first, *data};
}

/// Header of a matrix.
struct MatrixHead {
  std::uint32_t matrix_class = 0;
  bool complex = false;
  std::uint64_t elements = 0;
  std::string_view name;
};

std::optional<MatrixHead> take_matrix_head(ByteReader& reader, std::endian order) {
  const auto flags = take_element(reader);
  if (!flags || flags->type != kUint32 || flags->data.size() != 8) return std::nullopt;
  const auto dimensions = take_element(reader);
  if (!dimensions || dimensions->type != kInt32 || dimensions->data.size() % 4 != 0) return std::nullopt;
  const auto name = take_element(reader);
  if (!name || name->type != kInt8) return std::nullopt;

  MatrixHead head;
  const std::uint32_t word = value_from<std::uint32_t>(flags->data, order);
  head.matrix_class = word & 0xff;
  head.complex = (word & kComplexFlag) != 0;
  head.name = text_of(name->data);
  head.elements = dimensions->data.empty() ? 0 : 1;
  for (std::size_t i = 0; i < dimensions->data.size(); i += 4) {
    const std::int32_t extent = value_from<std::int32_t>(dimensions->data.subspan(i), order);
    if (extent < 0) return std::nullopt;
    const auto factor = static_cast<std::uint64_t>(extent);
    if (factor != 0 && head.elements > std::numeric_limits<std::uint64_t>::max() / factor) return std::nullopt;
    head.elements *= factor;
  }
  return head;
}

std::optional<NumericArray> numeric_array_in(std::span<const std::uint8_t> matrix, std::endian order) {
  ByteReader reader(matrix, order);
  const auto head = take_matrix_head(reader, order);
  if (!head || head->complex || head->matrix_class < kFirstNumericClass || head->matrix_class > kLastNumericClass) {
    return std::nullopt;
  }
  const auto numbers = take_element(reader);
  if (!numbers) return std::nullopt;
  const std::size_t size = bytes_of(numbers->type);
  if (size == 0 || numbers->data.size() % size != 0 || numbers->data.size() / size != head->elements) {
    return std::nullopt;
  }
  return NumericArray(numbers->type, numbers->data, order);
}

enum class Inflated { kAll, kStart };

/// @param limit  kAll: more than this is an error; kStart: stop there
Result<std::vector<std::uint8_t>> inflate_data(std::span<const std::uint8_t> data, Inflated part, std::uint64_t limit) {
  z_stream stream = {};
  if (inflateInit(&stream) != Z_OK) return fail(Error::Code::kIo, "there is not enough memory to inflate its data");
  const auto end = [](z_stream* s) { inflateEnd(s); };
  const std::unique_ptr<z_stream, decltype(end)> ended_at_last(&stream, end);

  stream.next_in = const_cast<Bytef*>(data.data());  // zlib's interface predates const; it does not write there
  stream.avail_in = static_cast<uInt>(data.size());  // from a 32-bit count
  std::vector<std::uint8_t> out;
  for (;;) {
    const std::size_t size = out.size();
    constexpr std::size_t kMinRoom = std::size_t{1} << 12, kMaxRoom = std::size_t{1} << 30;  // zlib counts in 32 bits
    const std::uint64_t room = std::min<std::uint64_t>(std::clamp(size, kMinRoom, kMaxRoom), limit - size);
    if (room == 0) {
      if (part == Inflated::kStart) return out;
      return fail(Error::Code::kCorrupt, fmt::format("its data inflate to more than {} bytes", limit));
    }
    out.resize(size + static_cast<std::size_t>(room));
    stream.next_out = out.data() + size;
    stream.avail_out = static_cast<uInt>(room);
    const int state = inflate(&stream, Z_NO_FLUSH);
    out.resize(out.size() - stream.avail_out);
    if (state == Z_STREAM_END) return out;
    if (part == Inflated::kStart && out.size() == size) return out;
    if (state == Z_BUF_ERROR || (state == Z_OK && stream.avail_in == 0 && out.size() == size)) {
      return fail(Error::Code::kCorrupt, "its compressed data end early");
    }
    if (state != Z_OK) return fail(Error::Code::kCorrupt, "its compressed data are damaged");
  }
}

bool has_mark(std::span<const std::uint8_t> bytes, std::string_view mark) {
  return bytes.size() >= kHeaderBytes && text_of(bytes).substr(126, 2) == mark;
}

/// Version in the header: 1 for level 5, 2 for 7.3; high byte of the u16 before the endian mark.
int version_of(std::span<const std::uint8_t> bytes) {
  if (has_mark(bytes, "IM")) return bytes[125];
  return has_mark(bytes, "MI") ? bytes[124] : 0;
}

/// Name of the variable of a matrix element, from its first bytes.
std::optional<std::string> name_in(std::span<const std::uint8_t> bytes, std::endian order) {
  ByteReader reader(bytes, order);
  if (!reader.take(kTagBytes)) return std::nullopt;
  const auto head = take_matrix_head(reader, order);
  if (!head) return std::nullopt;
  return std::string(head->name);
}

/// The matrix element of a variable, including its tag.
Result<std::vector<std::uint8_t>> find_variable(const FileBytes& file, std::endian order, std::string_view variable) {
  const auto view = file.view();
  ByteReader reader(view, order);
  reader.take(kHeaderBytes);
  std::string others;
  std::size_t count = 0;
  while (reader.left() > 0) {
    const std::size_t start = reader.position();
    const auto element = take_element(reader);
    if (!element) {
      return fail(Error::Code::kCorrupt,
                  fmt::format("{}: byte {}: a data element that does not fit into the {} bytes that are left: is the "
                              "file cut off?",
                              file.name, start, view.size() - start));
    }
    const auto in_place = [&file, start](const Error& error) {
      return tl::unexpected(Error{error.code, fmt::format("{}: byte {}: {}", file.name, start, error.message)});
    };
    std::vector<std::uint8_t> matrix;
    std::optional<std::string> name;
    if (element->type == kMatrix) {
      const auto with_tag = view.subspan(start, reader.position() - start);
      name = name_in(with_tag, order);
      if (name == variable) return std::vector<std::uint8_t>(with_tag.begin(), with_tag.end());
    } else if (element->type == kCompressed) {
      // Inflates only the name, to skip other large variables.
      const auto beginning = inflate_data(element->data, Inflated::kStart, std::uint64_t{1} << 12);
      if (!beginning) return in_place(beginning.error());
      name = name_in(*beginning, order);
      if (name == variable) {
        auto all = inflate_data(element->data, Inflated::kAll, kMaxInflation * element->data.size() + kAlwaysInflated);
        if (!all) return in_place(all.error());
        return std::move(*all);
      }
    }
    if (!name) continue;
    if (++count <= 8) others += fmt::format("{}{}", count == 1 ? "" : ", ", printable(*name));
    if (count == 9) others += ", ...";
  }
  return fail(Error::Code::kUnsupported,
              others.empty() ? fmt::format("{}: holds no variable {}", file.name, variable)
                             : fmt::format("{}: holds no variable {} (but {})", file.name, variable, others));
}

}  // namespace

std::size_t NumericArray::size() const {
  return bytes_.size() / bytes_of(stored_type_);
}

double NumericArray::at(std::size_t index) const {
  const auto number = bytes_.subspan(index * bytes_of(stored_type_));
  const auto as_double = [&]<class T>(T) { return static_cast<double>(value_from<T>(number, order_)); };
  switch (stored_type_) {
    case kInt8:
      return as_double(std::int8_t{});
    case kUint8:
      return as_double(std::uint8_t{});
    case kInt16:
      return as_double(std::int16_t{});
    case kUint16:
      return as_double(std::uint16_t{});
    case kInt32:
      return as_double(std::int32_t{});
    case kUint32:
      return as_double(std::uint32_t{});
    case kSingle:
      return as_double(float{});
    case kDouble:
      return as_double(double{});
    case kInt64:
      return as_double(std::int64_t{});
    default:
      assert(stored_type_ == kUint64);
      return as_double(std::uint64_t{});
  }
}

Result<StructArray> StructArray::open(FileBytes file, std::string_view variable) {
  const auto view = file.view();
  const bool little = has_mark(view, "IM");
  if (version_of(view) == 2 || text_of(view).starts_with("MATLAB 7.3 MAT-file")) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: is a MATLAB 7.3 file (HDF5); save it with -v7 to have it read", file.name));
  }
  if (version_of(view) != 1) {
    return fail(Error::Code::kCorrupt,
                fmt::format("{}: has no whole header of 128 bytes of a MATLAB level-5 file", file.name));
  }
  const std::endian order = little ? std::endian::little : std::endian::big;

  Result<std::vector<std::uint8_t>> matrix = find_variable(file, order, variable);
  if (!matrix) return tl::unexpected(matrix.error());
  const auto corrupt = [&](std::string_view what) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: {}: {}", file.name, variable, what));
  };

  StructArray array(std::move(*matrix), order);
  ByteReader outer(array.bytes_, order);
  const auto element = take_element(outer);
  if (!element || element->type != kMatrix) return corrupt("is not a whole matrix");
  ByteReader reader(element->data, order);
  const auto head = take_matrix_head(reader, order);
  if (!head) return corrupt("its head is damaged");
  if (head->matrix_class != kStructClass) {
    return fail(Error::Code::kUnsupported, fmt::format("{}: {}: is not an array of structs", file.name, variable));
  }

  const auto name_length = take_element(reader);
  if (!name_length || name_length->type != kInt32 || name_length->data.size() != 4) {
    return corrupt("the length of its field names is damaged");
  }
  const std::int32_t length = value_from<std::int32_t>(name_length->data, order);
  const auto names = take_element(reader);
  if (!names || names->type != kInt8 || length <= 0) return corrupt("its field names are damaged");
  const auto step = static_cast<std::size_t>(length);
  if (names->data.size() % step != 0 || names->data.size() / step > kMaxFields) {
    return corrupt("its field names are damaged");
  }
  for (std::size_t i = 0; i < names->data.size(); i += step) {
    const std::string_view name = text_of(names->data.subspan(i, step));
    array.fields_.emplace_back(name.substr(0, name.find('\0')));
  }

  // Checks the tags of all elements once.
  if (array.fields_.empty() || head->elements > reader.left() / kTagBytes / array.fields_.size()) {
    return corrupt(fmt::format("{} records of {} fields do not fit into its {} bytes", head->elements,
                               array.fields_.size(), reader.left()));
  }
  array.reader_ = reader;
  array.elements_left_ = head->elements;
  for (std::uint64_t i = 0; i < head->elements * array.fields_.size(); ++i) {
    const auto field = take_element(reader);
    if (!field || field->type != kMatrix) {
      return corrupt(fmt::format("record {}: its frame is broken", i / array.fields_.size() + 1));
    }
  }
  return array;
}

std::optional<std::size_t> StructArray::field(std::string_view name) const {
  const auto found = std::find(fields_.begin(), fields_.end(), name);
  if (found == fields_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - fields_.begin());
}

std::optional<std::vector<std::optional<NumericArray>>> StructArray::next() {
  if (elements_left_ == 0) return std::nullopt;
  --elements_left_;
  std::vector<std::optional<NumericArray>> arrays;
  arrays.reserve(fields_.size());
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const auto element = take_element(*reader_);
    assert(element);  // checked by open()
    arrays.push_back(numeric_array_in(element->data, order_));
  }
  return arrays;
}

bool looks_like_matlab(std::span<const std::uint8_t> bytes) {
  const std::string_view text = text_of(bytes);
  return text.starts_with("MATLAB 5.0 MAT-file") || text.starts_with("MATLAB 7.3 MAT-file") || version_of(bytes) == 1 ||
         version_of(bytes) == 2;
}

}  // namespace pingvox::mat5
