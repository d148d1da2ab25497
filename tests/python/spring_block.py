"""A rigid block on a spring along x as the solid of a run: `spring_block.py STIFFNESS` (N/m). See docs/protocol.md."""
import ctypes, itertools, json, os, sys
import iceoryx2 as iox2, numpy as np
def wire(name, size, **fields):  # of each field: type, byte offset
    t = type(name, (ctypes.Structure,), {"_fields_": [("words", ctypes.c_uint64 * (size // 8))]})
    t.type_name, (formats, offsets) = staticmethod(lambda: f"halfstep.{name}"), zip(*fields.values())
    t.dtype = np.dtype({"names": list(fields), "formats": formats, "offsets": offsets, "itemsize": size})
    return t
def view(address, t, count=1): return np.frombuffer((t * count).from_address(address), t.dtype)
State = wire("StateRecord.1", 128, id=("u4", 0), position=("3f8", 8), velocity=("3f8", 32), density=("f8", 56), mass=("f8", 72))
Force = wire("ForceRecord.1", 56, viscous=("3f8", 8), stress=("3f8", 32))
StateHead = wire("StateHeader.2", 224, run_id=("u8", 0), schema=("u8", 8), protocol=("u4", 16), status=("u4", 20), step=("u8", 24),
                 stage=("u4", 32), count=("u4", 36), time=("f8", 48), dt=("f8", 56), dt_limit=("f8", 64),
                 abilities=("u4", 88), checkpoint_safe=("u4", 92))
ForceHead = wire("ForceHeader.2", 88, order=("u4", 20), step=("u8", 24), stage=("u4", 32), dt=("f8", 56), next_time=("f8", 64),
                 checkpoint=("u8", 80))
env, stiffness = {k[9:]: v for k, v in os.environ.items() if k.startswith("HALFSTEP_")}, float(sys.argv[1])
name, parent, partners = env["NAME"], os.getppid(), len({pair.split(":")[1] for pair in env["PROCESSES"].split(",")})  # of fluid and coupler
scene = json.load(open(env["SCENE"]))
box = next(shape["geometry"]["box"] for shape in scene["shapes"] if shape["phase"] == "solid")
dx, dimension, density = scene["resolution"], scene["dimension"], scene["solid"]["density"]
axes = [np.arange(a + dx / 2, b, dx) if k < dimension else [0.0] for k, (a, b) in enumerate(zip(box["min"], box["max"]))]
rest, mass = np.array(list(itertools.product(*axes))), density * dx**dimension  # of all particles; of each
config, same = iox2.config.default(), iox2.AttributeVerifier.new()
config.global_cfg.prefix, config.global_cfg.root_path = iox2.FileName.new(env["PREFIX"]), iox2.Path.new(env["ROOT"])
node = iox2.NodeBuilder.new().config(config).signal_handling_mode(iox2.SignalHandlingMode.Disabled).create(iox2.ServiceType.Ipc)
for key in ("schema", "protocol"): same = same.require(iox2.AttributeKey.new("halfstep." + key), iox2.AttributeValue.new(env[key.upper()]))
def event(process, callers):
    service = node.service_builder(iox2.ServiceName.new(f"halfstep/{process}/wake")).event()
    return service.max_listeners(1).max_notifiers(callers).max_nodes(callers + 1).open_or_create_with_attributes(same)
def channel(kind, readers, record, header):
    s = node.service_builder(iox2.ServiceName.new(f"halfstep/{name}/{kind}")).publish_subscribe(iox2.Slice[record]).user_header(header)
    s = s.enable_safe_overflow(False).history_size(0).subscriber_max_buffer_size(2).subscriber_max_borrowed_samples(2)
    return s.max_publishers(1).max_subscribers(readers).max_nodes(readers + 1).open_or_create_with_attributes(same)
def wait(condition):
    while not (found := condition()): listener.timed_wait(iox2.Duration.from_millis(5)), os.getppid() == parent or sys.exit("left alone")
    return found
events, forces = [event(name, 2), event("fluid", partners), event("coupler", partners)], channel("force", 1, Force, ForceHead)
listener, inbox = events[0].listener_builder().create(), forces.subscriber_builder().create()
outbox = channel("state", 2, State, StateHead).publisher_builder().initial_max_slice_len(int(env["CAPACITY"])).create()
wait(lambda: forces.dynamic_config.number_of_publishers and (inbox.has_samples() or True))  # which also connects
notifiers = [service.notifier_builder().create() for service in events[1:]]
wait(lambda: events[0].dynamic_config.number_of_notifiers == 2)
def send(count, **fields):
    sample, (ids, at, speed) = outbox.loan_slice_uninit(count), (np.arange(count), rest[:count] + (x_mid, 0, 0), (v_mid, 0, 0))
    ctypes.memset(sample.user_header_ptr, 0, 224), ctypes.memset(sample.payload_ptr, 0, 128 * count)
    head, state = view(sample.user_header_ptr, StateHead), view(sample.payload_ptr, State, count)
    state["id"], state["position"], state["velocity"], state["density"], state["mass"] = ids, at, speed, density, mass
    fields |= {key: int(env[key.upper()]) for key in ("run_id", "schema", "protocol")} | {"count": count}
    for field, value in fields.items(): head[field] = value
    sample.assume_init().send(), [notifier.notify() for notifier in notifiers]
x = v = x_mid = v_mid = dt = time = 0.0  # displacement and velocity: at step n; at the stage
first = safe = 0
if "CHECKPOINT" in env:  # the state at the first step to be done
    first, time, x, v = np.fromfile(f"{env['CHECKPOINT']}/{name}.hdf").tolist()
    first, x_mid, v_mid = int(first), x, v
for step, stage in ((half // 2, half % 2) for half in itertools.count(2 * first)):
    send(len(rest), step=step, stage=stage, time=time, dt=dt * stage, dt_limit=1e30, abilities=1, checkpoint_safe=safe)
    answer = wait(inbox.receive)
    head, force = view(answer.user_header_ptr, ForceHead)[0], view(answer.payload_ptr, Force, answer.header.number_of_elements)
    assert (head["step"], head["stage"]) == (step, stage)
    if head["order"] & 4:
        safe = int(head["checkpoint"])
        file = f"{env['OUT']}/checkpoint-{'ab'[(safe - 1) % 2]}/{name}.hdf"
        np.array([step, time, x, v]).tofile(file + ".tmp"), os.replace(file + ".tmp", file)
    if head["order"] & 8: sys.exit(send(0, step=step, stage=2, time=time, status=3, checkpoint_safe=safe))
    load, dt = (mass * force["viscous"] + force["stress"])[:, 0].sum(), float(head["dt"])
    h, a = (dt if stage else dt / 2), (load - stiffness * x_mid) / (mass * len(rest))
    x_mid, v_mid = x + h * v_mid, v + h * a
    if stage: x, v, time = x_mid, v_mid, float(head["next_time"])
