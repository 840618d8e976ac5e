"""Ends the script that imports it where Python is too old for it; itself it runs on any Python."""

import sys

if sys.version_info < (3, 10):  # noqa: UP036
    version = (sys.argv[0], sys.version_info[0], sys.version_info[1])
    sys.exit("%s needs Python 3.10 or newer; this is Python %d.%d" % version)  # noqa: UP031
