#include "viewer/server/tls.h"

#include <gmock/gmock.h>

#include <boost/asio/read.hpp>
#include <boost/asio/ssl/rfc2818_verification.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <string>

#include "calib/model/errors.h"
#include "test_browser.h"
#include "viewer/server/server.h"

namespace rgbdt::viewer {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
using boost::system::error_code;
using testing::EndsWith;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;
using tcp = net::ip::tcp;

const TlsIdentity& Identity() {
  static const TlsIdentity identity = SelfSignedIdentity({"192.0.2.7", "2001:db8::7"});
  return identity;
}

/// Trusts nothing but that certificate, for that name.
net::ssl::context Trusting(const TlsIdentity& identity, const std::string& name) {
  net::ssl::context context(net::ssl::context::tls_client);
  context.set_verify_mode(net::ssl::verify_peer);
  context.add_certificate_authority(net::buffer(identity.certificate));
  context.set_verify_callback(net::ssl::rfc2818_verification(name));
  return context;
}

class TlsTest : public ::testing::Test {
 protected:
  using Stream = net::ssl::stream<tcp::socket>;

  static ServerOptions Options() {
    ServerOptions options;
    options.port = 0;
    options.page = "the page";
    options.token = "s3cret";
    options.tls = Identity();
    return options;
  }
  void Connect(Stream* stream) const {
    stream->next_layer().connect({net::ip::address_v4::loopback(), static_cast<uint16_t>(port_)});
    stream->handshake(net::ssl::stream_base::client);
  }
  /// What comes back, to the end of TLS.
  std::string Get(net::ssl::context context, const std::string& request) {
    Stream stream(io_, context);
    Connect(&stream);
    net::write(stream, net::buffer(request));
    std::string answer;
    error_code error;
    net::read(stream, net::dynamic_buffer(answer), error);
    EXPECT_EQ(error, net::error::eof) << "closed as TLS wants it, not torn off";
    return answer;
  }

  Server server_{Options(), nullptr};
  int port_ = PortOf(server_);
  std::string host_ = "127.0.0.1:" + std::to_string(port_);
  net::io_context io_;
};

TEST_F(TlsTest, ServesThePage) {
  EXPECT_EQ(server_.Url(), "https://" + host_ + "/#token=s3cret");
  const std::string answer = Get(Trusting(Identity(), "127.0.0.1"), GetRequest("/", host_));
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(answer, HasSubstr("connect-src 'self' wss://" + host_ + ";"));
  EXPECT_THAT(answer, EndsWith("the page"));
}

TEST_F(TlsTest, WhoComesInClearIsToldWhatToDo) {
  const std::string answer = Exchange(port_, GetRequest("/", host_));
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(answer, HasSubstr("write https:// before its address"));
}

TEST_F(TlsTest, TheWebSocketTakesTheTokenByTlsFromItsOwnOriginOnly) {
  net::ssl::context context = Trusting(Identity(), "localhost");
  const auto hello = [&](const std::string& origin) {
    beast::websocket::stream<Stream> socket(io_, context);
    Connect(&socket.next_layer());
    socket.set_option(
        beast::websocket::stream_base::decorator([&](beast::websocket::request_type& request) {
          request.set(beast::http::field::origin, origin);
        }));
    socket.handshake(host_, "/ws");
    socket.write(net::buffer(std::string(R"({"type": "hello", "token": "s3cret"})")));
    beast::flat_buffer frame;
    socket.read(frame);
    error_code ignored;
    socket.close(beast::websocket::close_code::normal, ignored);
    return beast::buffers_to_string(frame.data());
  };
  EXPECT_THAT(hello("https://" + host_), HasSubstr("\"may_command\":true"));
  EXPECT_THROW(hello("http://" + host_), boost::system::system_error);
  EXPECT_THROW(hello("https://evil.example"), boost::system::system_error);
}

TEST_F(TlsTest, TheCertificateIsForItsNamesAlone) {
  for (const char* name : {"localhost", "127.0.0.1", "192.0.2.7", "2001:db8::7"}) {
    net::ssl::context context = Trusting(Identity(), name);
    Stream stream(io_, context);
    EXPECT_NO_THROW(Connect(&stream)) << name;
  }
  for (const char* name : {"evil.example", "192.0.2.8"}) {
    net::ssl::context context = Trusting(Identity(), name);
    Stream stream(io_, context);
    EXPECT_THROW(Connect(&stream), boost::system::system_error) << name;
  }
  net::ssl::context other = Trusting(SelfSignedIdentity({}), "localhost");
  Stream stream(io_, other);
  EXPECT_THROW(Connect(&stream), boost::system::system_error) << "another one's";
}

TEST_F(TlsTest, OldVersionsAreRefused) {
  net::ssl::context context = Trusting(Identity(), "localhost");
  SSL_CTX_set_security_level(context.native_handle(), 0);  // or this end would not even ask
  SSL_CTX_set_max_proto_version(context.native_handle(), TLS1_1_VERSION);
  Stream stream(io_, context);
  EXPECT_THROW(Connect(&stream), boost::system::system_error);
}

TEST_F(TlsTest, WhatIsNoTlsHurtsNobody) {
  HeldConnection broken(port_), silent(port_);
  broken.Say(std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11) +
             std::string(600, 'x'));
  silent.Say(std::string("\x16\x03\x01", 3));
  EXPECT_THAT(Get(Trusting(Identity(), "localhost"), GetRequest("/", host_)),
              StartsWith("HTTP/1.1 200 "));
}

TEST(Tls, EachCertificateIsItsOwn) {
  EXPECT_THAT(FingerprintOf(Identity()), MatchesRegex("([0-9A-F]{2}:){31}[0-9A-F]{2}"));
  EXPECT_NE(FingerprintOf(Identity()), FingerprintOf(SelfSignedIdentity({})));
}

std::string WhyNot(const TlsIdentity& identity) {
  try {
    identity.Check();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Tls, WhatIsNoIdentityIsRefused) {
  EXPECT_EQ(WhyNot(Identity()), "");
  EXPECT_THAT(WhyNot({"", Identity().key}), HasSubstr("the certificate is none"));
  EXPECT_THAT(WhyNot({Identity().key, Identity().key}), HasSubstr("the certificate is none"));
  EXPECT_THAT(WhyNot({Identity().certificate, ""}), HasSubstr("the key is none"));
  EXPECT_THAT(WhyNot({Identity().certificate, SelfSignedIdentity({}).key}),
              HasSubstr("another certificate's"));
  EXPECT_THROW(FingerprintOf({"nothing", ""}), InputError);
  ServerOptions options;
  options.tls = TlsIdentity{"nothing", "nothing"};
  EXPECT_THROW(options.Check(), InputError);
}

// With names that are none in a certificate, such as a link-local address' interface.
TEST(Tls, OddAddressesAreLeftOut) {
  EXPECT_EQ(WhyNot(SelfSignedIdentity({"fe80::1%3", "a,DNS:evil.example", "", "0.0.0.0"})), "");
}

}  // namespace
}  // namespace rgbdt::viewer
