// A transport between ranks that are threads of one process, with faults on request.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "study/executor/message_transport.hpp"

namespace armwright {

// The network of a job. It keeps messages until they are received.
class MemoryNetwork {
 public:
  explicit MemoryNetwork(std::size_t ranks) : arrived_(ranks) {}

  std::size_t size() const { return arrived_.size(); }
  void send(std::size_t from, std::size_t to, std::string message) {
    const std::lock_guard lock(mutex_);
    if (!dead_.contains(from) && !dead_.contains(to)) {
      (held_.contains(from) ? kept_ : arrived_[to]).push_back({from, std::move(message)});
    }
  }
  std::optional<MessageTransport::Message> receive(std::size_t rank) {
    const std::lock_guard lock(mutex_);
    if (dead_.contains(rank) || arrived_[rank].empty()) {
      return std::nullopt;
    }
    MessageTransport::Message message = std::move(arrived_[rank].front());
    arrived_[rank].pop_front();
    return message;
  }

  // Loses all messages to and from the rank from now on.
  void kill(std::size_t rank) {
    const std::lock_guard lock(mutex_);
    dead_.insert(rank);
  }
  // Holds back the messages that the rank sends, until let_go().
  void hold(std::size_t rank) {
    const std::lock_guard lock(mutex_);
    held_.insert(rank);
  }
  void let_go(std::size_t rank) {
    const std::lock_guard lock(mutex_);
    held_.erase(rank);
    for (MessageTransport::Message& message : std::exchange(kept_, {})) {
      arrived_[0].push_back(std::move(message));
    }
  }

 private:
  std::mutex mutex_;
  std::vector<std::deque<MessageTransport::Message>> arrived_;  // by receiver
  std::deque<MessageTransport::Message> kept_;                  // held back, for the coordinator
  std::set<std::size_t> dead_;
  std::set<std::size_t> held_;
};

class MemoryTransport final : public MessageTransport {
 public:
  MemoryTransport(MemoryNetwork& network, std::size_t rank) : network_(network), rank_(rank) {}
  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return network_.size(); }
  void send(std::size_t to, std::string message) override {
    network_.send(rank_, to, std::move(message));
  }
  std::optional<Message> receive() override { return network_.receive(rank_); }

 private:
  MemoryNetwork& network_;
  std::size_t rank_;
};

}  // namespace armwright
