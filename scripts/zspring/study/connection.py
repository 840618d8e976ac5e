"""Connect to a Dask cluster: one that runs, or processes on this machine."""

from __future__ import annotations

import asyncio
import logging
import signal
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress

import dask
from distributed import Client, LocalCluster, Security, TimeoutError
from distributed.comm import get_address_host_port
from distributed.core import rpc

from ..errors import ZSpringError
from .cluster import Cluster

# What Dask's processes do beside the work, on two processors taken from it.
QUIET = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "5s",
}


@contextmanager
def connected(scheduler: str | None, workers: int, timeout: float) -> Iterator[Cluster]:
    """A Dask cluster: that of the scheduler's address, or None for so many processes on this machine.

    timeout     s, for the scheduler to answer and to have a worker
    Raises ZSpringError if there is no scheduler or it has no workers.
    """
    with ExitStack() as stack:
        stack.enter_context(dask.config.set(QUIET))
        for name in ("asyncio", "distributed", "distributed.client", "distributed.scheduler", "distributed.nanny"):
            logging.getLogger(name).setLevel(logging.CRITICAL)  # what matters is said here in one line
        if scheduler:
            _check_scheduler(scheduler, timeout)
            client = stack.enter_context(Client(scheduler, timeout=timeout, set_as_default=False))
        else:
            with _without_interrupt():
                local = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    memory_limit=0,
                    dashboard_address="127.0.0.1:0",
                    silence_logs=logging.CRITICAL,
                )
            stack.callback(_close, local)
            client = stack.enter_context(Client(local, set_as_default=False))
        try:
            client.wait_for_workers(1, timeout=timeout)
        except TimeoutError:
            raise ZSpringError(f"--scheduler {scheduler}: has no workers (waited {timeout:g} s)") from None
        yield Cluster(client, timeout)


def _close(local: LocalCluster) -> None:
    """End the processes. The results are there, and Dask asserts that one it was just starting anew had begun."""
    with suppress(AssertionError):
        local.close()


def _check_scheduler(address: str, timeout: float) -> None:
    """Raises ZSpringError unless a Dask scheduler answers at the address within the timeout (s).

    A Client would wait for ever for a server that accepts the connection and then says nothing.
    """

    async def identity() -> dict:
        get_address_host_port(address)
        async with rpc(address, connection_args=Security().get_connection_args("client")) as server:
            return await server.identity()

    try:
        is_scheduler = asyncio.run(asyncio.wait_for(identity(), timeout)).get("type") == "Scheduler"
    except ValueError as error:
        raise ZSpringError(f"--scheduler {address}: {error}") from None
    except (OSError, TimeoutError):
        raise ZSpringError(f"--scheduler {address}: no answer in {timeout:g} s") from None
    except Exception:  # whatever another server's bytes were taken for
        is_scheduler = False
    if not is_scheduler:
        raise ZSpringError(f"--scheduler {address}: is no Dask scheduler")


@contextmanager
def _without_interrupt() -> Iterator[None]:
    """Processes started meanwhile do not notice Ctrl-C: it is for the one that started them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, previous)
