#pragma once

#include <string>
#include <vector>

namespace rgbdt::viewer {

/// What a server proves with who it is: PEM texts. The certificate may be a chain, its own first.
struct TlsIdentity {
  std::string certificate, key;

  /// Throws InputError where either is none, the key has a passphrase, or is another certificate's.
  void Check() const;
};

/// Made anew, on the curve P-256, valid for ten years, for this machine's names and these
/// addresses. Nobody vouches for it: a person compares its fingerprint.
TlsIdentity SelfSignedIdentity(const std::vector<std::string>& addresses);

/// SHA-256 of the certificate, "AB:CD:...", as browsers show it. Throws InputError where it is
/// none.
std::string FingerprintOf(const TlsIdentity& identity);

}  // namespace rgbdt::viewer
