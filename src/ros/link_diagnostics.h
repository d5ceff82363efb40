#pragma once
/// What flight_link_node says of the link: its status message and its diagnostics.

#include <diagnostic_updater/diagnostic_updater.h>
#include <snapwing/LinkStatus.h>

#include "link_worker.h"
#include "snapwing/common/loan.h"

namespace snapwing::nodes {

LinkStatus toMessage(const link::BridgeStatus& status, const link::OperatorLink& link);

class LinkDiagnostics {
 public:
  /// @param interval  [s] between two looks
  LinkDiagnostics(const LinkWorker& worker, double interval);
  void update() { updater_.update(); }

 private:
  using Wrapper = diagnostic_updater::DiagnosticStatusWrapper;
  void diagnoseLink(Wrapper& out);
  void diagnoseController(Wrapper& out);

  common::Loan<const LinkWorker> worker_;
  double interval_;
  link::LinkCounters last_;
  diagnostic_updater::Updater updater_;
};

}  // namespace snapwing::nodes
