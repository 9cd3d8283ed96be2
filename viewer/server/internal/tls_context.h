#pragma once

#include <boost/asio/ssl/context.hpp>

#include "viewer/server/internal/net.h"
#include "viewer/server/tls.h"

namespace rgbdt::viewer {

/// For a server: TLS 1.2 and newer. Throws as TlsIdentity::Check.
net::ssl::context TlsContext(const TlsIdentity& identity);

}  // namespace rgbdt::viewer
