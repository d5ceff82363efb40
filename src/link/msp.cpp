#include "snapwing/link/msp.h"

#include <cstring>

#include "crc.h"

namespace snapwing::link {

std::size_t encodeMsp(const MspPacket& packet, std::uint8_t* out, std::size_t capacity) {
  const bool v1 = packet.version == MspVersion::V1;
  const std::size_t head = v1 ? 5 : 8;
  if (packet.size > MSP_MAX_PAYLOAD || capacity < head + packet.size + 1) return 0;
  if (v1 && (packet.id > 255 || packet.size > 254)) return 0;
  out[0] = '$';
  out[1] = v1 ? 'M' : 'X';
  out[2] = static_cast<std::uint8_t>(packet.direction);
  if (v1) {
    out[3] = static_cast<std::uint8_t>(packet.size);
    out[4] = static_cast<std::uint8_t>(packet.id);
  } else {
    out[3] = packet.flags;
    out[4] = static_cast<std::uint8_t>(packet.id & 0xFF);
    out[5] = static_cast<std::uint8_t>(packet.id >> 8);
    out[6] = static_cast<std::uint8_t>(packet.size & 0xFF);
    out[7] = static_cast<std::uint8_t>(packet.size >> 8);
  }
  std::memcpy(out + head, packet.payload.data(), packet.size);
  std::uint8_t sum = 0;
  if (v1) {
    for (std::size_t i = 3; i < head + packet.size; ++i) sum ^= out[i];
  } else {
    sum = crc8DvbS2(out + 3, head - 3 + packet.size);
  }
  out[head + packet.size] = sum;
  return head + packet.size + 1;
}

bool MspParser::reject() {
  ++bad_frames_;
  state_ = State::START;
  return false;
}

void MspParser::check(std::uint8_t byte) {
  check_ = packet_.version == MspVersion::V1 ? static_cast<std::uint8_t>(check_ ^ byte) : crc8DvbS2(&byte, 1, check_);
}

void MspParser::afterHeader() {
  received_ = 0;
  state_ = packet_.size == 0 ? State::CHECK : State::PAYLOAD;
}

bool MspParser::push(std::uint8_t byte) {
  switch (state_) {
    case State::START:
      if (byte == '$') state_ = State::VERSION;
      return false;
    case State::VERSION:
      if (byte != 'M' && byte != 'X') {
        state_ = byte == '$' ? State::VERSION : State::START;
        return false;
      }
      packet_.version = byte == 'M' ? MspVersion::V1 : MspVersion::V2;
      packet_.flags = 0;
      check_ = 0;
      state_ = State::DIRECTION;
      return false;
    case State::DIRECTION:
      if (byte != '<' && byte != '>' && byte != '!') return reject();
      packet_.direction = static_cast<char>(byte);
      state_ = packet_.version == MspVersion::V1 ? State::V1_SIZE : State::V2_FLAGS;
      return false;
    case State::PAYLOAD:
      check(byte);
      packet_.payload[received_++] = byte;
      if (received_ == packet_.size) state_ = State::CHECK;
      return false;
    case State::CHECK:
      if (byte != check_) return reject();
      state_ = State::START;
      return true;
    default:
      return header(byte);
  }
}

bool MspParser::header(std::uint8_t byte) {
  check(byte);
  switch (state_) {
    case State::V1_SIZE:
      if (byte == 255) return reject();
      packet_.size = byte;
      state_ = State::V1_ID;
      break;
    case State::V1_ID:
      packet_.id = byte;
      afterHeader();
      break;
    case State::V2_FLAGS:
      packet_.flags = byte;
      state_ = State::V2_ID_LOW;
      break;
    case State::V2_ID_LOW:
      packet_.id = byte;
      state_ = State::V2_ID_HIGH;
      break;
    case State::V2_ID_HIGH:
      packet_.id = static_cast<std::uint16_t>(packet_.id | (byte << 8));
      state_ = State::V2_SIZE_LOW;
      break;
    case State::V2_SIZE_LOW:
      packet_.size = byte;
      state_ = State::V2_SIZE_HIGH;
      break;
    default:
      packet_.size |= static_cast<std::size_t>(byte) << 8;
      if (packet_.size > MSP_MAX_PAYLOAD) return reject();
      afterHeader();
      break;
  }
  return false;
}

}  // namespace snapwing::link
