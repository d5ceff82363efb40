"""For a node that has finished a run and wants its report while the recorder still runs."""

import os

import rospy
from std_srvs.srv import Trigger

from snapwing_tools import report_command


def make_report(folder, vehicle_file, mount="auto", recorder="record_run", patience=5.0):
    """`mount`: what the vehicle hung on (auto, free, boom, held). Has `recorder` save folder/run.h5 and makes folder/report.html of it and of folder/run_summary.json, if there.
    Blocks for some seconds up to a minute. Returns "" or, in one line, why there is no report."""
    service = recorder + "/save"
    try:
        rospy.wait_for_service(service, patience)
        answer = rospy.ServiceProxy(service, Trigger)()
    except (rospy.ROSException, rospy.ServiceException) as error:
        return "the recorder does not answer: {}".format(error)
    if not answer.success:
        return answer.message
    arguments = [os.path.join(folder, "run.h5"), "--vehicle", vehicle_file, "--snapwing", "auto",
                 "--trial=--mount " + mount, "-o", os.path.join(folder, "report.html")]
    try:
        return "" if report_command.main(arguments) == 0 else "make_report failed; its message is above"
    except Exception as error:  # the run's own outcome must not hang on a defect of the report
        return "make_report failed: {!r}".format(error)
