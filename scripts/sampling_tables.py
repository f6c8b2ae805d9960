# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the sampling tables that come with the package: run it where `prefilter` can be imported.

usage: sampling_tables.py FOLDER    (native/python/prefilter/sampling/tables)
"""

import sys
from pathlib import Path

from prefilter import SAMPLING_FILTERS, SamplingTable
from prefilter.sampling.sampling_table import STANDARD_TARGETS, STANDARD_TEXELS


def main(folder: Path) -> None:
    """Writes a file for each filter, target and number of texels."""
    for name, target in [*((name, None) for name in SAMPLING_FILTERS), *STANDARD_TARGETS]:
        for texels in STANDARD_TEXELS:
            table = SamplingTable.build(name, texels=texels, target=target)
            whole = name if target is None else f"{name}-{target}"
            table.save(folder / f"{whole}-{texels}.json")
            print(f"{whole}, {texels} texels: {table.error_ratio:.4f} of trilinear")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
