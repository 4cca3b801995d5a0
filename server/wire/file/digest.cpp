#include "server/wire/file/digest.hpp"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/rand.h>

#include <memory>
#include <new>
#include <stdexcept>

namespace isthmus {
namespace {

template <auto function>
struct Release {
  template <class T>
  void operator()(T* object) const {
    function(object);
  }
};

/// Looking up an algorithm takes longer than the sum itself: once a thread.
EVP_MAC_CTX* hmac_context() {
  thread_local const std::unique_ptr<EVP_MAC, Release<EVP_MAC_free>> hmac(
      EVP_MAC_fetch(nullptr, "HMAC", nullptr));
  thread_local const std::unique_ptr<EVP_MAC_CTX, Release<EVP_MAC_CTX_free>> context(
      EVP_MAC_CTX_new(hmac.get()));
  if (!context) throw std::bad_alloc();
  return context.get();
}

/// As above.
EVP_MD* sha256_algorithm() {
  thread_local const std::unique_ptr<EVP_MD, Release<EVP_MD_free>> algorithm(
      EVP_MD_fetch(nullptr, "SHA256", nullptr));
  if (!algorithm) throw std::bad_alloc();
  return algorithm.get();
}

}  // namespace

Digest sha256(std::span<const std::uint8_t> bytes) {
  Digest digest{};
  const int done =
      EVP_Digest(bytes.data(), bytes.size(), digest.data(), nullptr, sha256_algorithm(), nullptr);
  if (done != 1) throw std::bad_alloc();  // OpenSSL has no other reason here
  return digest;
}

Digest hmac_sha256(std::span<const std::uint8_t> key, std::span<const std::uint8_t> bytes) {
  char algorithm[] = "SHA256";
  const std::array parameters = {OSSL_PARAM_construct_utf8_string("digest", algorithm, 0),
                                 OSSL_PARAM_construct_end()};
  EVP_MAC_CTX* context = hmac_context();
  Digest digest{};
  std::size_t size = 0;
  const bool done = EVP_MAC_init(context, key.data(), key.size(), parameters.data()) == 1 &&
                    EVP_MAC_update(context, bytes.data(), bytes.size()) == 1 &&
                    EVP_MAC_final(context, digest.data(), &size, digest.size()) == 1;
  if (!done || size != digest.size()) throw std::bad_alloc();  // as above
  return digest;
}

bool begins_with(const Digest& expected, std::span<const std::uint8_t> bytes) {
  return bytes.size() <= expected.size() && CRYPTO_memcmp(expected.data(), bytes.data(), bytes.size()) == 0;
}

std::array<std::uint8_t, 16> random_bytes() {
  std::array<std::uint8_t, 16> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1)
    throw std::runtime_error("the system has no random numbers");
  return bytes;
}

}  // namespace isthmus
