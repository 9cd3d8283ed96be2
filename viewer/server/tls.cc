#include "viewer/server/tls.h"

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>

#include "calib/model/errors.h"
#include "viewer/server/internal/origin.h"
#include "viewer/server/internal/tls_context.h"

namespace rgbdt::viewer {
namespace {

template <auto Free>
struct FreeWith {
  template <typename T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Certificate = std::unique_ptr<X509, FreeWith<X509_free>>;
using PrivateKey = std::unique_ptr<EVP_PKEY, FreeWith<EVP_PKEY_free>>;
using Text = std::unique_ptr<BIO, FreeWith<BIO_free>>;

constexpr int kVersion3 = 2;  // as X.509 counts
constexpr long kSecondsPerDay = 86400;
constexpr long kDays = 3650;
constexpr std::size_t kMaxNames = 100;

[[noreturn]] void FailTls(const std::string& what) { throw InputError("TLS: " + what); }

void Require(bool good, const char* what) {
  if (!good) FailTls(std::string("OpenSSL cannot make ") + what);
}

std::string TextOf(const Text& text) {
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(text.get(), &bytes);
  return size > 0 ? std::string(bytes, static_cast<std::size_t>(size)) : std::string();
}

bool IsDnsName(const std::string& name) {
  return !name.empty() && name.size() <= 253 &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '.'; });
}

// "DNS:rig,IP:192.168.0.2"
std::string AlternativeNames(const std::vector<std::string>& names) {
  std::string text;
  std::size_t count = 0;
  for (const std::string& name : names) {
    boost::system::error_code error;
    const net::ip::address address = net::ip::make_address(name, error);
    if (count == kMaxNames || (error && !IsDnsName(name))) continue;
    if (!error && address.is_v6() && address.to_v6().scope_id() != 0) continue;
    text += (text.empty() ? "" : ",") + (error ? "DNS:" + name : "IP:" + address.to_string());
    ++count;
  }
  return text.empty() ? "DNS:localhost" : text;
}

void AddExtension(X509* certificate, int what, const std::string& value) {
  using Extension = std::unique_ptr<X509_EXTENSION, FreeWith<X509_EXTENSION_free>>;
  const Extension extension(X509V3_EXT_conf_nid(nullptr, nullptr, what, value.c_str()));
  Require(extension && X509_add_ext(certificate, extension.get(), -1) == 1, "an extension");
}

void SetSerial(X509* certificate) {
  std::array<unsigned char, 8> serial{};
  Require(RAND_bytes(serial.data(), serial.size()) == 1, "a random number");
  std::uint64_t number = 0;
  for (const unsigned char byte : serial) number = number << 8 | byte;
  ASN1_INTEGER_set_uint64(X509_get_serialNumber(certificate), number >> 1 | 1U);
}

}  // namespace

TlsIdentity SelfSignedIdentity(const std::vector<std::string>& addresses) {
  std::vector<std::string> names = MachineNames();
  names.insert(names.end(), {"localhost", "127.0.0.1", "::1"});
  names.insert(names.end(), addresses.begin(), addresses.end());
  const PrivateKey key(EVP_EC_gen("P-256"));
  const Certificate certificate(X509_new());
  Require(key && certificate, "a key");
  X509_set_version(certificate.get(), kVersion3);
  SetSerial(certificate.get());
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -kSecondsPerDay);  // clocks differ
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), kDays * kSecondsPerDay);
  X509_NAME* name = X509_get_subject_name(certificate.get());
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>("rgbdt-viewer"), -1, -1, 0);
  X509_set_issuer_name(certificate.get(), name);
  X509_set_pubkey(certificate.get(), key.get());
  AddExtension(certificate.get(), NID_subject_alt_name, AlternativeNames(names));
  AddExtension(certificate.get(), NID_basic_constraints, "critical,CA:FALSE");
  AddExtension(certificate.get(), NID_ext_key_usage, "serverAuth");
  Require(X509_sign(certificate.get(), key.get(), EVP_sha256()) > 0, "a signature");
  const Text certificate_text(BIO_new(BIO_s_mem())), key_text(BIO_new(BIO_s_mem()));
  Require(PEM_write_bio_X509(certificate_text.get(), certificate.get()) == 1 &&
              PEM_write_bio_PrivateKey(key_text.get(), key.get(), nullptr, nullptr, 0, nullptr,
                                       nullptr) == 1,
          "a certificate");
  return {TextOf(certificate_text), TextOf(key_text)};
}

std::string FingerprintOf(const TlsIdentity& identity) {
  const Text text(
      BIO_new_mem_buf(identity.certificate.data(), static_cast<int>(identity.certificate.size())));
  const Certificate certificate(PEM_read_bio_X509(text.get(), nullptr, nullptr, nullptr));
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (!certificate || X509_digest(certificate.get(), EVP_sha256(), digest.data(), &size) != 1) {
    FailTls("the certificate is none, or is not PEM (-----BEGIN CERTIFICATE-----)");
  }
  std::string fingerprint;
  for (unsigned i = 0; i < size; ++i) {
    std::array<char, 4> byte{};
    std::snprintf(byte.data(), byte.size(), i == 0 ? "%02X" : ":%02X", digest[i]);
    fingerprint += byte.data();
  }
  return fingerprint;
}

net::ssl::context TlsContext(const TlsIdentity& identity) {
  boost::system::error_code error;
  net::ssl::context context(net::ssl::context::tls_server);
  SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
  // Nobody is asked for a passphrase on the terminal.
  context.set_password_callback(
      [](std::size_t, net::ssl::context::password_purpose) { return std::string(); });
  context.use_certificate_chain(net::buffer(identity.certificate), error);
  if (error) FailTls("the certificate is none, or is not PEM: " + error.message());
  context.use_private_key(net::buffer(identity.key), net::ssl::context::pem, error);
  if (error) {
    FailTls("the key is none, has a passphrase, or is another certificate's: " + error.message());
  }
  return context;
}

void TlsIdentity::Check() const { TlsContext(*this); }

}  // namespace rgbdt::viewer
