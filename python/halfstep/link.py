"""The connection to a run: its environment, its services, sending, waiting, and leaving. See docs/protocol.md."""

import ctypes
import fcntl
import os
import shutil
import sys
import time

import iceoryx2 as iox2
import numpy as np

from . import wire
from .answer import EPOCH, Sent, check

# Nothing wakes a process when another one opens its services.
HANDSHAKE_MS = 5
# A wake-up comes with every message; this is how often a silent partner is asked for.
SILENCE_MS = 50
SECONDS_BETWEEN_QUESTIONS = 1.0


class RunEnded(Exception):
    """The run is over for a reason that lies with another process."""


class Environment:
    """What the launcher tells in variables."""

    def __init__(self, variables=os.environ):
        self.values = {key[9:]: value for key, value in variables.items() if key.startswith("HALFSTEP_")}
        if "RUN_ID" not in self.values:
            sys.exit(
                "this program is the solid of a run: start it with `halfstep run SCENE --solid 'COMMAND'`, or alone "
                "with `halfstep fake-fluid SCENE --solid 'COMMAND'`"
            )
        for key, own in (("PROTOCOL", wire.PROTOCOL), ("SCHEMA", wire.schema())):
            if self.number(key) != own:
                told = f"the run has HALFSTEP_{key}={self[key]}, this package speaks {own}"
                sys.exit(f"{told}: both must be of one version")

    def __getitem__(self, key):
        return self.values[key]

    def get(self, key):
        return self.values.get(key)

    def number(self, key):
        return int(self.values[key])

    def processes(self):
        """The process of each participant."""
        return dict(pair.split(":") for pair in self["PROCESSES"].split(","))


class Link:
    """Both channels of a solid that is a process of its own, and the wake-up calls of its partners."""

    def __init__(self, environment):
        self.environment = environment
        self.name = environment["NAME"]
        self.capacity = environment.number("CAPACITY")
        self.identity = {key: environment.number(key.upper()) for key in ("run_id", "protocol", "schema")}
        self.parent = os.getppid()
        self.claim = Claim(environment)
        self._handshake()

    def _handshake(self):
        environment, name = self.environment, self.name
        # Errors come as exceptions; what else the transport has to say is about files that others removed first.
        iox2.set_log_level(iox2.LogLevel.Fatal)
        self.config = iox2.config.default()
        self.config.global_cfg.prefix = iox2.FileName.new(environment["PREFIX"])
        self.config.global_cfg.root_path = iox2.Path.new(environment["ROOT"])
        builder = iox2.NodeBuilder.new().config(self.config)
        self.node = builder.signal_handling_mode(iox2.SignalHandlingMode.Disabled).create(iox2.ServiceType.Ipc)
        self.attributes = iox2.AttributeVerifier.new()
        for key in ("schema", "protocol"):
            pair = iox2.AttributeKey.new(f"halfstep.{key}"), iox2.AttributeValue.new(environment[key.upper()])
            self.attributes = self.attributes.require(*pair)
        processes = environment.processes()
        own, partners = processes[name], (processes["fluid"], "coupler")
        solids = len(set(processes.values()) - {processes["fluid"]})
        self.partners, self.is_connected = len(partners), False
        self.wake = self._event(own, self.partners)
        # The fluid and the coupler are called by each other and by every process of solids.
        calls = [self._event(partner, solids + 1) for partner in partners]
        forces = self._channel("force", 1, wire.FORCE_RECORD, wire.FORCE_HEADER)
        states = self._channel("state", 2, wire.STATE_RECORD, wire.STATE_HEADER)
        self.listener = self.wake.listener_builder().create()
        self.inbox = forces.subscriber_builder().create()
        self.outbox = states.publisher_builder().initial_max_slice_len(self.capacity).create()
        limit = float(environment["HANDSHAKE_SECONDS"])
        self._wait(lambda: forces.dynamic_config.number_of_publishers > 0, HANDSHAKE_MS, limit)
        # This connects the subscriber.
        self.inbox.has_samples()
        self.notifiers = [call.notifier_builder().create() for call in calls]
        self._wait(lambda: self._callers() == self.partners, HANDSHAKE_MS, limit)
        self.is_connected = True

    def _callers(self):
        return self.wake.dynamic_config.number_of_notifiers

    def _event(self, process, callers):
        service = self.node.service_builder(iox2.ServiceName.new(f"halfstep/{process}/wake")).event()
        service = service.max_listeners(1).max_notifiers(callers).max_nodes(callers + 1)
        return service.open_or_create_with_attributes(self.attributes)

    def _channel(self, kind, readers, record, header):
        service = self.node.service_builder(iox2.ServiceName.new(f"halfstep/{self.name}/{kind}"))
        service = service.publish_subscribe(iox2.Slice[record.ctype]).user_header(header.ctype)
        service = service.enable_safe_overflow(False).history_size(0)
        service = service.subscriber_max_buffer_size(2).subscriber_max_borrowed_samples(2)
        service = service.max_publishers(1).max_subscribers(readers).max_nodes(readers + 1)
        return service.open_or_create_with_attributes(self.attributes)

    def _wait(self, find, milliseconds, limit):
        """What `find` returns once it is something; asleep meanwhile. `limit`: s."""
        began = asked = time.monotonic()
        while not (found := find()):
            self._sleep(milliseconds)
            now = time.monotonic()
            if os.getppid() != self.parent:
                raise RunEnded("the run's launcher has ended")
            if now - asked > SECONDS_BETWEEN_QUESTIONS:
                asked = now
                if self._is_left() and not (found := find()):
                    raise RunEnded("another process of the run has ended")
                if found:
                    return found
            if now - began > limit:
                raise RunEnded(f"no message for {limit:g} s")
        return found

    def _sleep(self, milliseconds):
        """Until a wake-up call, or so long; less where the process was stopped and goes on (SIGSTOP, SIGCONT)."""
        try:
            self.listener.timed_wait(iox2.Duration.from_millis(milliseconds))
        except iox2.ListenerWaitError as error:
            if str(error) != "InterruptSignal":
                raise

    def _is_left(self):
        """Whether a partner has ended: it lies dead, or somebody has cleaned up after it, or it has left by itself."""
        nodes = iox2.Node.list(iox2.ServiceType.Ipc, self.config)
        gone = self.is_connected and self._callers() < self.partners
        return gone or any(isinstance(node, iox2.NodeState.Dead) for node in nodes)

    def send(self, records, **header):
        """Publishes a state: an array of records, and fields of the header by name."""
        count = len(records)
        ids = records["id"].copy()
        self.sent = Sent(header["step"], header["stage"], header["time"], header.get("dt", 0.0), ids)
        sample = self.outbox.loan_slice_uninit(count)
        ctypes.memset(sample.user_header_ptr, 0, wire.STATE_HEADER.dtype.itemsize)
        if count:
            target = wire.STATE_RECORD.view(sample.payload_ptr, count)
            target[:] = records
        head = wire.STATE_HEADER.view(sample.user_header_ptr)
        for field, value in (self.identity | {"count": count, "epoch": EPOCH} | header).items():
            head[field] = value
        sample.assume_init().send()
        for notifier in self.notifiers:
            notifier.notify()

    def receive(self):
        """The answer to the state that was sent last: its header and its records, copied, then checked."""
        # Longer than the coupler, which knows who is silent and names it.
        patience = 1.5 * float(self.environment["PATIENCE_SECONDS"]) + 1.0
        sample = self._wait(self.inbox.receive, SILENCE_MS, patience)
        header = wire.FORCE_HEADER.view(sample.user_header_ptr)[0].copy()
        # `len` counts bytes in iceoryx2 0.10.
        count = sample.header.number_of_elements
        records = wire.FORCE_RECORD.view(sample.payload_ptr, count).copy() if count else _NO_FORCES
        check(self.identity, self.sent, header, records)
        return header, records

    def close(self):
        """Leaves the run. The connection is of no use afterwards."""
        for own in ("notifiers", "outbox", "inbox", "listener", "wake", "node"):
            self.__dict__.pop(own, None)
        self.claim.leave()


_NO_FORCES = np.zeros(0, wire.FORCE_RECORD.dtype)


class Claim:
    """Presence in a run: a shared lock on a file beside its objects. Who leaves last removes them."""

    FOLDER = "/dev/shm"

    def __init__(self, environment):
        self.prefix, self.root = environment["PREFIX"], environment["ROOT"]
        self.path = os.path.join(self.FOLDER, f"{self.prefix}lock")
        try:
            self.lock = os.open(self.path, os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC)
            fcntl.flock(self.lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError:
            raise SystemExit(f"the run {self.prefix} is over: {self.path} is not there to be locked") from None

    def leave(self):
        if self.lock is None:
            return
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if os.path.samestat(os.fstat(self.lock), os.stat(self.path)):
                self._remove()
        except OSError:
            # Somebody else is left, or has removed everything.
            pass
        os.close(self.lock)
        self.lock = None

    def _remove(self):
        shutil.rmtree(self.root, ignore_errors=True)
        lock = os.path.basename(self.path)
        own = [name for name in os.listdir(self.FOLDER) if name.startswith(self.prefix) and name != lock]
        # The lock goes last: a run that is left half removed is recognised by it.
        for name in own + [lock]:
            try:
                os.remove(os.path.join(self.FOLDER, name))
            except FileNotFoundError:
                pass
