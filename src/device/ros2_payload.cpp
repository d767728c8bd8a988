#include "device/ros2_payload.hpp"

#ifdef PINGVOX_HAS_ROS2

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>

// The operations that Cyclone asks for, in the order of its structs. They are called by C: nothing may be thrown.
namespace pingvox {
namespace {

constexpr std::size_t kHeaderBytes = 4, kAlignment = 4;
/// Larger ones are not messages of a sonar or of navigation.
constexpr std::size_t kMaxBytes = 256U << 20U;

/// A message, padded with zeros to a multiple of four bytes, as DDS sends it.
struct CdrPayload : ddsi_serdata {
  CdrPayload(const ddsi_sertype* of, ddsi_serdata_kind of_kind, std::string message) : bytes(std::move(message)) {
    ddsi_serdata_init(this, of, of_kind);
    bytes.resize((bytes.size() + kAlignment - 1) / kAlignment * kAlignment, '\0');
  }
  std::string bytes;
};

const CdrPayload& cdr_of(const ddsi_serdata* data) {
  return *static_cast<const CdrPayload*>(data);
}

/// nullptr: out of memory.
template <class Fill>
ddsi_serdata* make_cdr(const ddsi_sertype* type, ddsi_serdata_kind kind, Fill fill) {
  try {
    std::string bytes;
    if (!fill(bytes)) return nullptr;
    return new CdrPayload(type, kind, std::move(bytes));
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

bool has_equal_key(const ddsi_serdata*, const ddsi_serdata*) {
  return true;  // there are no keys
}

std::uint32_t size_of_payload(const ddsi_serdata* data) {
  return static_cast<std::uint32_t>(cdr_of(data).bytes.size());
}

ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                             std::size_t size) {
  if (size < kHeaderBytes || size > kMaxBytes) return nullptr;
  return make_cdr(type, kind, [&](std::string& bytes) {
    bytes.reserve(size + kAlignment);
    for (; fragment != nullptr; fragment = fragment->nextfrag) {
      // They may overlap.
      if (fragment->maxp1 <= bytes.size() || fragment->min > bytes.size()) continue;
      const char* const packet = reinterpret_cast<const char*>(fragment->rmsg + 1);
      const char* const payload = packet + fragment->payload_zoff;
      bytes.append(payload + (bytes.size() - fragment->min), fragment->maxp1 - bytes.size());
    }
    return bytes.size() == size;
  });
}

ddsi_serdata* from_buffers(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                           const ddsrt_iovec_t* buffers, std::size_t size) {
  if (size < kHeaderBytes || size > kMaxBytes) return nullptr;
  return make_cdr(type, kind, [&](std::string& bytes) {
    for (const ddsrt_iovec_t& buffer : std::span(buffers, count)) {
      const std::size_t part = std::min<std::size_t>(buffer.iov_len, size - bytes.size());
      bytes.append(static_cast<const char*>(buffer.iov_base), part);
    }
    return bytes.size() == size;
  });
}

ddsi_serdata* from_key(const ddsi_sertype* type, const ddsi_keyhash*) {
  return make_cdr(type, SDK_KEY, [](std::string&) { return true; });
}

ddsi_serdata* from_message(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* message) {
  return make_cdr(type, kind, [&](std::string& bytes) {
    if (kind == SDK_DATA) bytes = *static_cast<const std::string*>(message);
    return true;
  });
}

void copy_bytes(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* buffer) {
  std::memcpy(buffer, cdr_of(data).bytes.data() + offset, size);
}

ddsi_serdata* refer_to_bytes(const ddsi_serdata* data, std::size_t offset, std::size_t size, ddsrt_iovec_t* buffer) {
  buffer->iov_base = const_cast<char*>(cdr_of(data).bytes.data() + offset);
  buffer->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(data);
}

void end_reference(ddsi_serdata* data, const ddsrt_iovec_t*) {
  ddsi_serdata_unref(data);
}

bool to_message(const ddsi_serdata* data, void* message, void**, void*) {
  try {
    *static_cast<std::string*>(message) = cdr_of(data).bytes;
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

ddsi_serdata* without_type(const ddsi_serdata* data) {
  ddsi_serdata* const untyped = from_key(data->type, nullptr);
  if (untyped != nullptr) untyped->type = nullptr;
  return untyped;
}

bool without_type_to_message(const ddsi_sertype*, const ddsi_serdata*, void* message, void**, void*) {
  static_cast<std::string*>(message)->clear();
  return true;
}

void free_payload(ddsi_serdata* data) {
  delete static_cast<CdrPayload*>(data);
}

std::size_t print_payload(const ddsi_sertype*, const ddsi_serdata*, char* text, std::size_t size) {
  if (size > 0) *text = '\0';
  return 0;
}

void no_key(const ddsi_serdata*, ddsi_keyhash* key, bool) {
  std::ranges::fill(key->value, static_cast<unsigned char>(0));
}

constexpr ddsi_serdata_ops kPayloadOperations = {
    has_equal_key, size_of_payload, from_fragments, from_buffers, from_key,     from_message,
    copy_bytes,    refer_to_bytes,  end_reference,  to_message,   without_type, without_type_to_message,
    free_payload,  print_payload,   no_key,         nullptr,      nullptr};

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}

void clear_messages(const ddsi_sertype*, void* messages, std::size_t count) {
  for (std::string& message : std::span(static_cast<std::string*>(messages), count)) message.clear();
}

/// Only messages of our own are read into.
void no_messages(void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {}

void free_messages(const ddsi_sertype* type, void** messages, std::size_t count, dds_free_op_t) {
  if (count > 0) clear_messages(type, messages[0], count);
}

bool is_equal_type(const ddsi_sertype*, const ddsi_sertype*) {
  return true;  // those of one name and of these operations are
}

std::uint32_t hash_of_type(const ddsi_sertype*) {
  return 0;
}

const ddsi_sertype_ops kTypeOperations = {ddsi_sertype_v0, nullptr,       free_type,    clear_messages, no_messages,
                                          free_messages,   is_equal_type, hash_of_type, nullptr,        nullptr,
                                          nullptr,         nullptr,       nullptr,      nullptr};

}  // namespace

ddsi_sertype* make_payload_type(const std::string& name) {
  auto* const type = new (std::nothrow) ddsi_sertype;
  if (type == nullptr) return nullptr;
  ddsi_sertype_init_flags(type, name.c_str(), &kTypeOperations, &kPayloadOperations,
                          DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type;
}

void free_payload_type(ddsi_sertype* type) {
  ddsi_sertype_unref(type);
}

}  // namespace pingvox

#endif
