/// standin_replay: the first stand-in flight controller driven by a script on standard input, for test_two_standins.py.
/// First line: msp, sbus or crsf. Then one line per moment: microseconds, and bytes in hexadecimal or "-". For each it
/// prints: armed failsafe flags motor rc[8] answer.
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "standin_port.h"

using namespace snapwing;

int main() {
  std::string protocol, hex;
  std::cin >> protocol;
  standin::StandinSettings settings;
  settings.msp_rate = 96.037;  // no whole number of turns in half a second: nothing hangs on the last bit of a time
  standin::StandinController fc(settings, 0.0);
  standin::StandinPort port(protocol, fc, 0.0);
  long long time = 0;
  std::vector<std::uint8_t> bytes, answer(4096);
  while (std::cin >> time >> hex) {
    const double now = 1e-6 * static_cast<double>(time);
    std::size_t size = port.step(now, answer.data(), answer.size());
    bytes.clear();
    for (std::size_t i = 0; hex != "-" && i + 1 < hex.size(); i += 2) {
      bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
    }
    port.take(bytes.data(), bytes.size(), now);
    fc.step(now);
    const link::Channels seen = fc.seenChannels(now);
    std::printf("%d %d %u %d", fc.armed() ? 1 : 0, fc.failsafe() ? 1 : 0, fc.armingFlags(), fc.motorMicroseconds());
    for (std::size_t i = 0; i < 8; ++i) std::printf(" %d", seen.us[i]);
    std::printf(size > 0 ? " " : " -");
    for (std::size_t i = 0; i < size; ++i) std::printf("%02x", answer[i]);
    std::printf("\n");
  }
  return 0;
}
