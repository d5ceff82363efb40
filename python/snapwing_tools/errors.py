"""Error of the tools: the user gave something that cannot be used."""


class InputError(Exception):
    """A file or an argument is missing or wrong; the message is one line that names it and says why."""


def require_master():
    """InputError where no ROS master answers: rospy would end in a traceback, or wait for ever."""
    import rosgraph  # only where ROS is
    if not rosgraph.is_master_online():
        raise InputError("no ROS master answers at {}; start roscore or a launch file, or set ROS_MASTER_URI".format(
            rosgraph.get_master_uri()))


def not_opened(path, error):
    """InputError of an HDF5 file that h5py refused with `error` (an OSError)."""
    text = str(error)
    if "truncated file" in text:
        return InputError("{}: the file is cut off: it is shorter than its own header says".format(path))
    if "lock" in text:
        return InputError("{}: another program has the file open for writing".format(path))
    if "Permission denied" in text:
        return InputError("{}: may not be read (permission denied)".format(path))
    return InputError("{}: not an HDF5 file, or damaged".format(path))
