"""YAML as the C++ side reads it: whatever its strict reader refuses is refused here, too, in place of being read differently."""

import re

import yaml

from snapwing_tools.errors import InputError

LEADING_ZERO = re.compile(r"[-+]?0[0-9][0-9]*(\.[0-9]*)?([eE][-+]?[0-9]+)?$")
OTHER_NUMBER = re.compile(r"[-+]?(0[xXbBoO][0-9a-fA-F_]+|[0-9][0-9_]*_[0-9_]*(\.[0-9_]*)?|[0-9]+(:[0-9]+)+(\.[0-9]*)?)$")


def load_yaml(path):
    """The tree of a file with one document.

    Raises InputError for what is no YAML, more than one document, aliases of themselves, merge keys, keys given twice,
    and numbers that two readers take for two values (010, 0x10, 1_000, 1:30).
    """
    try:
        with open(path, encoding="utf-8-sig") as file:
            root = yaml.compose(file, Loader=yaml.SafeLoader)
        if root is None:
            return None
        _check(path, root, [], set())
        return yaml.SafeLoader("").construct_document(root)
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise InputError("{}: not YAML ({})".format(path, " ".join(str(error).split())))


def _check(path, node, above, done):
    """done: numbers of nodes that were looked through, so that aliases are not unfolded."""
    if id(node) in done:
        return
    line = node.start_mark.line + 1
    if any(node is other for other in above):
        raise InputError("{}: line {} names a node that holds this very line: an alias of itself".format(path, line))
    if isinstance(node, yaml.SequenceNode):
        for entry in node.value:
            _check(path, entry, above + [node], done)
    elif isinstance(node, yaml.MappingNode):
        seen = set()
        for key, value in node.value:
            name = str(key.value)
            if key.tag == "tag:yaml.org,2002:merge":
                raise InputError("{}: line {} holds a merge key '<<', which is not read; allowed: the keys themselves".format(
                    path, key.start_mark.line + 1))
            if name in seen:
                raise InputError("{}: line {}: '{}' is given twice".format(path, key.start_mark.line + 1, name))
            seen.add(name)
            _check(path, value, above + [node], done)
    elif node.style is None and (LEADING_ZERO.match(node.value) or OTHER_NUMBER.match(node.value)):
        raise InputError("{}: line {}: '{}' is read as different numbers by different readers; allowed: decimal digits "
                         "without a leading zero, or quotes around a text".format(path, line, node.value))
    done.add(id(node))
