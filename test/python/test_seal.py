"""Seal of commands: the same bytes as the nodes make, and keys that are refused."""
import os
import tempfile
import types
import unittest

from snapwing_tools import seal
from snapwing_tools.errors import InputError


class Seal(unittest.TestCase):
    def test_code_is_the_agreed_one(self):
        """The same number stands in test/link/command_seal_test.cpp."""
        content = seal.pulse_content(7, 0.9, 0.5, True, -0.25, hold=(0.2, 1.3))
        self.assertEqual(seal.code(bytes([1]) * 32, "a", content, 42, 5, 6).hex(),
                         "ce753d3c840d3721a19f6dd363942d2cf8d6987d7918df33118c392b68cd5cc9")

    def test_each_part_counts(self):
        def code(key=1, vehicle="a", content=seal.arm_content(True), numbers=(1, 2, 3)):
            return seal.code(bytes([key]) * 32, vehicle, content, *numbers)
        codes = {code(), code(key=2), code(vehicle="b"), code(content=seal.arm_content(False)),
                 code(content=seal.reset_content()), code(numbers=(2, 2, 3)), code(numbers=(1, 3, 3)), code(numbers=(1, 2, 4))}
        self.assertEqual(len(codes), 8)

    def test_fill(self):
        message, status = types.SimpleNamespace(), types.SimpleNamespace(session=4, number=5, vehicle_id="a")
        first = seal.fill(message, bytes(32), status, b"x").code
        self.assertEqual((message.session, message.status_number), (4, 5))
        self.assertNotEqual(first, seal.fill(message, bytes(32), status, b"x").code, "the nonce is new each time")

    def test_keys(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "key")
            with self.assertRaisesRegex(InputError, "cannot read"):
                seal.load_key(path)
            for text, mode, complaint in (("00" * 32 + "\n", 0o640, "0600"), ("00" * 31, 0o600, "64 hex"), ("zz" * 32, 0o600, "64 hex"),
                                          ("00" * 33, 0o600, "64 hex")):
                with open(path, "w", encoding="ascii") as stream:
                    stream.write(text)
                os.chmod(path, mode)
                with self.assertRaisesRegex(InputError, complaint):
                    seal.load_key(path)
            with open(path, "w", encoding="ascii") as stream:
                stream.write("0a" * 32 + "\n")
            os.chmod(path, 0o600)
            self.assertEqual(seal.load_key(path), bytes([10]) * 32)


if __name__ == "__main__":
    unittest.main()
