/// LCM's short datagram without liblcm: bytes, damage, and liblcm itself at the other end.
#include "snapwing/link/lcm_socket.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <net/if.h>
#include <net/route.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <random>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/link/clock.h"

namespace snapwing::link {
namespace {

using Bytes = std::vector<std::uint8_t>;

LcmKind parse(const Bytes& bytes, LcmDatagram& out) { return parseLcmDatagram(bytes.data(), bytes.size(), out); }

TEST(LcmDatagramBytes, AsLiblcmWritesThem) {
  const Bytes bytes = {'L', 'C', '0', '2', 0, 0, 0, 7, 'A', 'B', 0, 1, 2, 3};
  LcmDatagram out;
  ASSERT_EQ(parse(bytes, out), LcmKind::MESSAGE);
  EXPECT_EQ(out.channel, "AB");
  EXPECT_EQ(Bytes(out.data, out.data + out.size), (Bytes{1, 2, 3}));
}

TEST(LcmDatagramBytes, FragmentsAndDamageAreDropped) {
  LcmDatagram out;
  // Fragment of a message of 64 MB: number, size, offset, fragment 0 of 1000, channel.
  const Bytes fragment = {'L', 'C', '0', '3', 0, 0, 0, 1, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 232, 'A', 0, 1};
  EXPECT_EQ(parse(fragment, out), LcmKind::FRAGMENT);
  EXPECT_EQ(parse({}, out), LcmKind::MALFORMED);
  EXPECT_EQ(parse({'L', 'C', '0', '2', 0, 0, 0, 1}, out), LcmKind::MALFORMED) << "no channel";
  EXPECT_EQ(parse({'L', 'C', '0', '2', 0, 0, 0, 1, 0, 5}, out), LcmKind::MALFORMED) << "empty channel";
  EXPECT_EQ(parse({'L', 'C', '0', '2', 0, 0, 0, 1, 'A', 'B'}, out), LcmKind::MALFORMED) << "channel without end";
  EXPECT_EQ(parse({'L', 'C', '0', '1', 0, 0, 0, 1, 'A', 0, 5}, out), LcmKind::MALFORMED) << "other magic";
  Bytes longest = {'L', 'C', '0', '2', 0, 0, 0, 1};
  longest.insert(longest.end(), LCM_CHANNEL_LIMIT, 'x');
  longest.push_back(0);
  EXPECT_EQ(parse(longest, out), LcmKind::MESSAGE);
  EXPECT_EQ(out.size, 0U);
  longest.insert(longest.begin() + 8, 'x');
  EXPECT_EQ(parse(longest, out), LcmKind::MALFORMED) << "channel too long";
}

TEST(LcmDatagramBytes, RandomBytesStayWithinBounds) {
  std::mt19937 rng(7);
  for (int i = 0; i < 200000; ++i) {
    Bytes bytes(rng() % 100);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(rng() % 3 == 0 ? 0 : rng());
    if (bytes.size() > 4) std::memcpy(bytes.data(), "LC02", 4);
    LcmDatagram out;
    if (parse(bytes, out) != LcmKind::MESSAGE) continue;
    EXPECT_EQ(out.data + out.size, bytes.data() + bytes.size());
    EXPECT_GE(reinterpret_cast<const std::uint8_t*>(out.channel.data()), bytes.data());
  }
}

TEST(LcmUrl, WhatIsUnderstood) {
  for (const char* bad :
       {"", "memq://", "udpm://127.0.0.1:7667", "udpm://239.255.76.67", "udpm://239.255.76.67:0?ttl=0",
        "udpm://239.255.76.67:70000", "udpm://239.255.76.67:7667?ttl=256", "udpm://239.255.76.67:7667?ttl=-1",
        "udpm://239.255.76.670:7667"}) {
    EXPECT_THROW(LcmSocket socket(bad), common::SettingError) << bad;
  }
}

/// Runs `body` in a network of its own, in a child: an empty one, with the loopback up and no route at all.
/// @param multicast_route  the route by which liblcm finds the loopback
void inOwnNetwork(bool multicast_route, const std::function<bool()>& body) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  constexpr int GOOD = 0, BAD = 1, NOT_ALLOWED = 77;
  if (child == 0) {
    alarm(20);
    if (unshare(CLONE_NEWNET) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) _exit(NOT_ALLOWED);
    const int any = socket(AF_INET, SOCK_DGRAM, 0);
    ifreq lo{};
    std::strcpy(lo.ifr_name, "lo");
    lo.ifr_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK;
    if (ioctl(any, SIOCSIFFLAGS, &lo) != 0) _exit(NOT_ALLOWED);
    if (multicast_route) {
      rtentry route{};
      const auto put = [](sockaddr& where, const char* address) {
        auto& in = reinterpret_cast<sockaddr_in&>(where);
        in.sin_family = AF_INET;
        inet_pton(AF_INET, address, &in.sin_addr);
      };
      put(route.rt_dst, "224.0.0.0");
      put(route.rt_genmask, "240.0.0.0");
      put(route.rt_gateway, "0.0.0.0");
      char name[] = "lo";
      route.rt_dev = name;
      route.rt_flags = RTF_UP;
      if (ioctl(any, SIOCADDRT, &route) != 0) _exit(NOT_ALLOWED);
    }
    bool good = false;
    try {
      good = body();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
    }
    _exit(good ? GOOD : BAD);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == NOT_ALLOWED)
    GTEST_SKIP() << "network namespaces are not allowed here";
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == GOOD);
}

constexpr char URL[] = "udpm://239.255.76.67:7667?ttl=0";

bool hears(LcmSocket& socket, const Bytes& wanted) {
  LcmDatagram message;
  for (const double end = monotonicSeconds() + 2.0; monotonicSeconds() < end; socket.wait(0.01)) {
    if (!socket.receive(message)) continue;
    if (message.channel == "CHANNEL" && Bytes(message.data, message.data + message.size) == wanted) return true;
  }
  return false;
}

TEST(LcmSocketOnLoopback, NeedsNoRoute) {
  inOwnNetwork(false, [] {
    LcmSocket one(URL), other(URL);
    const Bytes bytes = {1, 2, 3};
    return one.publish("CHANNEL", bytes.data(), bytes.size()) && hears(other, bytes) && hears(one, bytes);
  });
}

TEST(LcmSocketOnLoopback, LiblcmHearsUs) {
  inOwnNetwork(true, [] {
    lcm::LCM theirs(URL);
    Bytes heard;
    const std::function<void(const lcm::ReceiveBuffer*, const std::string&)> keep =
        [&heard](const lcm::ReceiveBuffer* buffer, const std::string&) {
          const auto* data = static_cast<const std::uint8_t*>(buffer->data);
          heard.assign(data, data + buffer->data_size);
        };
    theirs.subscribeFunction<const std::function<void(const lcm::ReceiveBuffer*, const std::string&)>*>(
        "CHANNEL",
        [](const lcm::ReceiveBuffer* buffer, const std::string& channel,
           const std::function<void(const lcm::ReceiveBuffer*, const std::string&)>* call) {
          (*call)(buffer, channel);
        },
        &keep);
    LcmSocket ours(URL);
    Bytes bytes(1300, 9);  // nearly a packet
    if (!ours.publish("CHANNEL", bytes.data(), bytes.size())) return false;
    theirs.handleTimeout(2000);
    return heard == bytes;
  });
}

TEST(LcmSocketOnLoopback, WeHearLiblcmAndRefuseItsFragments) {
  inOwnNetwork(true, [] {
    LcmSocket ours(URL);
    lcm::LCM theirs(URL);
    const Bytes too_long(200000, 5), bytes(1300, 9);
    theirs.publish("CHANNEL", too_long.data(), static_cast<unsigned>(too_long.size()));
    theirs.publish("CHANNEL", bytes.data(), static_cast<unsigned>(bytes.size()));
    return hears(ours, bytes) && ours.fragments() >= 3;
  });
}

TEST(LcmSocketOnLoopback, TooLongIsNotSent) {
  inOwnNetwork(false, [] {
    LcmSocket ours(URL);
    const Bytes bytes(2000, 1);
    return ours.publish("C", bytes.data(), LCM_DATAGRAM_LIMIT - 10) &&
           !ours.publish("C", bytes.data(), LCM_DATAGRAM_LIMIT - 9) && !ours.publish("", bytes.data(), 1) &&
           !ours.publish(std::string(LCM_CHANNEL_LIMIT + 1, 'x'), bytes.data(), 1);
  });
}

}  // namespace
}  // namespace snapwing::link
