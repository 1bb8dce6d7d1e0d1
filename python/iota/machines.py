# SPDX-License-Identifier: Apache-2.0
"""Other machines, by a Ray cluster: for `iota rooms --ray` and `iota sweep --ray`."""

from __future__ import annotations

import importlib.util
import socket
from typing import Any

from iota.extras import how_to_get

NAMESPACE = "iota"
KNOCK = 5.0  # s, for a cluster to take a connection


def ray_at(address: str) -> Any:
    """Ray, connected to a cluster. address: such as 10.0.0.1:6379, "auto": the cluster that this machine belongs to.

    Raises ConnectionError, ValueError without the package.
    """
    if importlib.util.find_spec("ray") is None:
        raise ValueError(f"other machines are reached by Ray, which is not installed. {how_to_get('ray')}")
    import ray

    if not ray.is_initialized():
        try:
            if address != "auto":
                knock(address)
            ray.init(address=address, namespace=NAMESPACE, log_to_driver=False, configure_logging=False)
        except (OSError, ValueError, RuntimeError) as error:
            why = getattr(error, "strerror", None) or str(error).split("\n")[0]
            where = (
                "this machine is in no Ray cluster" if address == "auto" else f"there is no Ray cluster at {address}"
            )
            raise ConnectionError(f"{where} ({why}). Try: ray start --head") from None
    return ray


def knock(address: str) -> None:
    """Raises OSError if nobody listens there: Ray itself would try for minutes. Raises ValueError for another kind of address."""
    host, _, port = address.rpartition(":")
    if not (host and port.isdecimal()):
        raise ValueError("an address is like 10.0.0.1:6379")
    socket.create_connection((host.strip("[]"), int(port)), timeout=KNOCK).close()
