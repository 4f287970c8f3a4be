"""maturin, which builds the package, but for one thing: without Rust it says what to install, and downloads nothing."""

# Implements: PYT-047.

import shutil
import sys

from maturin import *  # noqa: F403
from maturin import get_requires_for_build_editable as _editable
from maturin import get_requires_for_build_wheel as _wheel


def _checked(requires):
    def wrapped(config_settings=None):
        if shutil.which("cargo") is None:
            sys.exit("palpate is compiled where it is installed, and found no Rust: install Rust 1.89 or later and a C compiler, then try again.")
        return requires(config_settings)

    return wrapped


get_requires_for_build_wheel = _checked(_wheel)
get_requires_for_build_editable = _checked(_editable)
