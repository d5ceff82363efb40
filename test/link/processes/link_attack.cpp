/// link_attack: a stray or hostile sender on the link's LCM network, for the fault table. It floods the command
/// channels with random bytes, with well-formed messages sealed with another key, or with malformed ones.
#include <poll.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "lcm_messages.h"
#include "snapwing/link/clock.h"
#include "snapwing/link/operator_link.h"
#include "snapwing/link/sealing.h"

using namespace snapwing;

namespace {

struct Message {
  const char* channel;
  std::vector<std::uint8_t> bytes;
};
using Messages = std::vector<Message>;

/// @param heard  the newest status of the bridge; its number and time go into the stamp
Messages wellFormed(const link::Key& key, std::int64_t session, const link::BridgeStatus& heard) {
  const link::Sealer sealer(key);
  link::PulseCommand pulse;
  pulse.stamp = {1, session, 1, heard.frame_time, 0.1, heard.number, 0.0};
  pulse.pulse_id = 1000000;
  pulse.throttle = pulse.duration = 1.0;
  return {
      {link::CHANNEL_PULSE, sealer.wrap(link::CHANNEL_PULSE, link::toLcm(pulse))},
      {link::CHANNEL_HEARTBEAT,
       sealer.wrap(link::CHANNEL_HEARTBEAT, link::toLcm(link::Heartbeat{pulse.stamp, true, true, true}))},
      {link::CHANNEL_ABORT, sealer.wrap(link::CHANNEL_ABORT, link::toLcm(link::Abort{pulse.stamp, 1}))},
  };
}

Messages garbage(std::mt19937& rng) {
  Messages messages = wellFormed({}, 1, {});
  for (Message& message : messages) {
    message.bytes.resize(64);
    for (auto& byte : message.bytes) byte = static_cast<std::uint8_t>(rng());
  }
  return messages;
}

/// Envelopes damaged from outside.
Messages damaged(const Messages& good, std::mt19937& rng) {
  Messages bad;
  for (int i = 0; i < 200; ++i) {
    Message message = good[rng() % good.size()];
    auto& bytes = message.bytes;
    const int kind = static_cast<int>(rng() % 4);
    if (kind == 0) bytes.resize(rng() % bytes.size());                   // cut
    if (kind == 1) bytes.resize(bytes.size() + 1 + rng() % 2000, 0xFF);  // drawn out
    if (kind == 2) {                                                     // flipped, not in the padding
      const std::size_t place = rng() % 60;
      bytes[place] = static_cast<std::uint8_t>(bytes[place] ^ 1U << rng() % 8);
    }
    if (kind == 3) {  // size of the payload
      for (std::size_t k = 12; k < 16; ++k) bytes[k] = static_cast<std::uint8_t>(rng());
    }
    bad.push_back(message);
  }
  return bad;
}

/// Sealed with the right key and in the right session, and yet not to be obeyed.
Messages absurd(const link::Key& key, std::int64_t session, const link::BridgeStatus& heard, std::mt19937& rng) {
  const link::Sealer sealer(key);
  const double wild[] = {std::nan(""), std::numeric_limits<double>::infinity(), -1.0, 1e308, 1.0001, -0.5, 1e-300};
  Messages bad;
  for (int i = 0; i < 200; ++i) {
    link::PulseCommand pulse;
    pulse.stamp = {77, session, i + 1, heard.frame_time, 0.1, heard.number, 0.0};
    pulse.pulse_id = static_cast<std::int64_t>(rng());
    pulse.throttle = wild[rng() % 7];
    pulse.duration = wild[rng() % 7];
    if (i % 3 == 0) {  // sound but for its hold
      pulse.throttle = pulse.duration = 0.2;
      pulse.hold_throttle = wild[rng() % 7];
      pulse.hold_duration = i % 2 == 0 ? 0.0 : wild[rng() % 7];
    }
    if (i % 5 == 0) pulse.stamp.time = wild[rng() % 7];
    snapwing_lcm::pulse_command_t wire = link::toLcm(pulse);
    if (i % 7 == 0) wire.stamp.version += 1 + static_cast<int>(rng() % 100);
    if (i % 11 == 0) wire.stamp.expiry_us = -static_cast<std::int32_t>(rng() % 1000000);
    bad.push_back({link::CHANNEL_PULSE, sealer.wrap(link::CHANNEL_PULSE, wire)});
  }
  return bad;
}

Messages malformed(const std::string& url, const link::Key& key, std::mt19937& rng) {
  link::OperatorLink listener(url, link::Sealer(key));
  for (int i = 0; i < 100 && listener.session() == 0; ++i) listener.handle(0.01);
  if (listener.session() == 0) throw std::runtime_error("no bridge heard");
  Messages messages = damaged(wellFormed(key, listener.session(), listener.status()), rng);
  for (Message& message : absurd(key, listener.session(), listener.status(), rng))
    messages.push_back(std::move(message));
  return messages;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Hostile sender for tests"};
  std::string url, mode = "garbage", key_file;
  double rate = 100000, seconds = 1;
  app.add_option("--lcm-url", url)->required();
  app.add_option("--mode", mode)->check(CLI::IsMember({"garbage", "forged", "malformed"}));
  app.add_option("--key-file", key_file, "the bridge's, for malformed");
  app.add_option("--rate", rate, "messages a second");
  app.add_option("--seconds", seconds);
  CLI11_PARSE(app, argc, argv);
  link::LcmSocket bus(url);
  std::mt19937 rng(7);
  link::Key foreign;
  for (auto& byte : foreign) byte = static_cast<std::uint8_t>(rng());
  const Messages messages = mode == "garbage"  ? garbage(rng)
                            : mode == "forged" ? wellFormed(foreign, 1, {})
                                               : malformed(url, link::loadKeyFile(key_file), rng);
  const double start = link::monotonicSeconds();
  long sent = 0;
  for (double now = start; now - start < seconds; now = link::monotonicSeconds()) {
    const long due = std::lround((now - start) * rate);
    for (; sent < due; ++sent) {
      const Message& message = messages[static_cast<std::size_t>(sent) % messages.size()];
      bus.publish(message.channel, message.bytes.data(), message.bytes.size());
    }
    poll(nullptr, 0, rate > 10000 ? 0 : 1);
  }
  std::printf("%ld messages in %.3f s\n", sent, link::monotonicSeconds() - start);
  return 0;
}
