"""Runs the examples of a page in a folder: `python howto.py PAGE FOLDER`."""

# Implements: PYT-030.

import doctest
import os
import sys

page = os.path.abspath(sys.argv[1])
os.chdir(sys.argv[2])
failed, run = doctest.testfile(page, module_relative=False, optionflags=doctest.ELLIPSIS)
print(f"{os.path.basename(page)}: {run} examples, {failed} failed")
sys.exit(1 if failed or run < 10 else 0)
