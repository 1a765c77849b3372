# SPDX-License-Identifier: BSD-3-Clause
import os
import sys

import pytest

sys.path.insert(0, os.path.dirname(__file__))


def pytest_configure(config):
    config.addinivalue_line("markers", "bits: compares bits of two programs, which have the same where no product is fused into a sum")


def pytest_collection_modifyitems(items):
    if os.environ.get("FRACFIT_FUSED") == "1":
        for item in items:
            if item.get_closest_marker("bits"):
                item.add_marker(pytest.mark.skip(reason="products are fused into sums, in each program by its own inlining"))
