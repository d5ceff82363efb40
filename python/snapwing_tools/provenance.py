"""Hashes and versions that tie a report to its inputs."""

import hashlib
import os
import re


def sha256_of_file(path):
    """SHA-256 of a file's bytes, or None if it cannot be read."""
    digest = hashlib.sha256()
    try:
        with open(path, "rb") as file:
            for block in iter(lambda: file.read(1 << 20), b""):
                digest.update(block)
    except OSError:
        return None
    return digest.hexdigest()


def package_root():
    """Folder of the package's source or share space (with package.xml), or None."""
    folder = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    if os.path.isfile(os.path.join(folder, "package.xml")):
        return folder
    try:
        import rospkg
        return rospkg.RosPack().get_path("snapwing")
    except Exception:  # rospkg absent, or the package is in none of its paths
        return None


def package_version():
    """Version as package.xml has it, or "unknown"."""
    root = package_root()
    try:
        with open(os.path.join(root or "", "package.xml")) as file:
            found = re.search(r"<version>\s*([^<\s]+)\s*</version>", file.read())
            return found.group(1) if found else "unknown"
    except OSError:
        return "unknown"
