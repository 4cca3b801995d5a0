#include "server/wire/envelope.hpp"

#include <openssl/crypto.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>

#include "isthmus/signed_t.hpp"
#include "server/wire/byte_check.hpp"
#include "server/wire/encoded.hpp"

namespace isthmus {
namespace {

constexpr std::size_t mac_bytes = 32;
constexpr std::int32_t most_payload_bytes = 1024 * 1024;
constexpr std::array members = {text(64), text(64), fixed(8), array(1, most_payload_bytes),
                                fixed(static_cast<std::int32_t>(mac_bytes))};

using Mac = std::array<std::uint8_t, mac_bytes>;

template <auto function>
struct Release {
  template <class T>
  void operator()(T* object) const {
    function(object);
  }
};

/// Looking up an algorithm takes longer than the sum itself: once a thread.
EVP_MAC_CTX* hmac_sha256() {
  thread_local const std::unique_ptr<EVP_MAC, Release<EVP_MAC_free>> hmac(
      EVP_MAC_fetch(nullptr, "HMAC", nullptr));
  thread_local const std::unique_ptr<EVP_MAC_CTX, Release<EVP_MAC_CTX_free>> context(
      EVP_MAC_CTX_new(hmac.get()));
  if (!context) throw std::bad_alloc();
  return context.get();
}

Mac mac_of(const AuthKey& key, std::span<const std::uint8_t> bytes) {
  char digest[] = "SHA256";
  const std::array parameters = {OSSL_PARAM_construct_utf8_string("digest", digest, 0),
                                 OSSL_PARAM_construct_end()};
  EVP_MAC_CTX* context = hmac_sha256();
  Mac mac{};
  std::size_t size = 0;
  const bool done = EVP_MAC_init(context, key.data(), key.size(), parameters.data()) == 1 &&
                    EVP_MAC_update(context, bytes.data(), bytes.size()) == 1 &&
                    EVP_MAC_final(context, mac.data(), &size, mac.size()) == 1;
  if (!done || size != mac.size()) throw std::bad_alloc();  // OpenSSL has no other reason here
  return mac;
}

}  // namespace

Message seal(const AuthKey& key, const std::string& sender, std::int64_t counter, const Message& message) {
  signed_t envelope{};
  envelope.channel = message.channel;
  envelope.sender = sender;
  envelope.counter = counter;
  envelope.npayload = static_cast<std::int32_t>(message.bytes.size());
  envelope.payload = message.bytes;
  Message sealed{message.utime, signed_channel, encoded(envelope)};
  const std::size_t signed_bytes = sealed.bytes.size() - mac_bytes;
  const Mac mac = mac_of(key, std::span(sealed.bytes).first(signed_bytes));
  std::copy(mac.begin(), mac.end(), sealed.bytes.begin() + static_cast<std::ptrdiff_t>(signed_bytes));
  return sealed;
}

std::string read_envelope(std::span<const std::uint8_t> bytes, Envelope& envelope) {
  const std::string_view reason = check_bytes(signed_t::getHash(), members, bytes);
  if (!reason.empty()) return std::string(reason);
  signed_t message;
  const int size = static_cast<int>(bytes.size());
  if (message.decode(bytes.data(), 0, size) != size) return "bad_length";
  envelope.channel = std::move(message.channel);
  envelope.sender = std::move(message.sender);
  envelope.counter = message.counter;
  envelope.payload = std::move(message.payload);
  return "";
}

bool is_genuine(const AuthKey& key, std::span<const std::uint8_t> bytes) {
  const std::size_t signed_bytes = bytes.size() - mac_bytes;
  const Mac mac = mac_of(key, bytes.first(signed_bytes));
  // In a time that tells nothing of where they differ.
  return CRYPTO_memcmp(mac.data(), bytes.subspan(signed_bytes).data(), mac_bytes) == 0;
}

}  // namespace isthmus
