"""Install pip into the environment that runs this file, where Python came without ensurepip.

Debian leaves ensurepip out of python3, and without root nobody can add it. The wheel's digest is
pinned, and the pip it holds then follows the user's own pip configuration.
"""

import hashlib
import os
import ssl
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

URL = "https://files.pythonhosted.org/packages/07/25/ee8c38ae72d66b844ce8eb9711ba905dba21ca1a8a0c960057c41cd23337/pip-26.3-py3-none-any.whl"
SHA256 = "f3b60b20ffaadd4415ed7957212a38ac63fa4c5fa375bd0f4a797777940fad13"


def main() -> None:
    """Download, check and install the wheel."""
    trusted = os.environ.get("PIP_CERT") or os.environ.get("REQUESTS_CA_BUNDLE")
    context = ssl.create_default_context(cafile=trusted)
    with urllib.request.urlopen(URL, timeout=30, context=context) as response:
        wheel: bytes = response.read()
    if hashlib.sha256(wheel).hexdigest() != SHA256:
        sys.exit(f"{URL} is not the file that was pinned")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / URL.rpartition("/")[2]
        path.write_bytes(wheel)
        # A wheel is a zip file, and Python runs packages out of zip files.
        command = [sys.executable, f"{path}/pip", "install", "--quiet", "--no-index", str(path)]
        subprocess.run(command, check=True)


if __name__ == "__main__":
    try:
        main()
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"{URL}: {error}")
