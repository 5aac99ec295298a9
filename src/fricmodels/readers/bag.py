"""Joint states in ROS bags, by rosbags (extra ``ros``)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.errors import InputError
from fricmodels.readers.base import Reader

if TYPE_CHECKING:
    import pandas as pd

_QUANTITIES = ("position", "velocity", "effort")


class BagReader(Reader):
    """ROS 1 and ROS 2 bags with ``sensor_msgs/JointState``.

    The columns are ``time_s`` since the first message, by its stamp, and for each joint ``JOINT.position``,
    ``JOINT.velocity`` and ``JOINT.effort``, so far as they are there. Where several topics carry joint states, each
    is a run of its own, named in the column ``run``.
    """

    name = "bag"
    suffixes = (".bag", ".mcap", ".db3")
    summary = "ROS bags with sensor_msgs/JointState (extra: ros)"
    apart = True

    def table(self, path: Path) -> pd.DataFrame:
        """Return one row for each message."""
        import pandas as pd

        topics = _joint_states(path)
        frames = [pd.DataFrame(_row(message, stamp) for message, stamp in rows) for rows in topics.values()]
        for topic, frame in zip(topics, frames, strict=True):
            if len(topics) > 1:
                frame["run"] = topic
        whole = pd.concat(frames, ignore_index=True)
        stamp = whole.pop("stamp")
        whole.insert(0, "time_s", (stamp - stamp.min()) * 1e-9)
        return whole


def _joint_states(path: Path) -> dict[str, list[tuple[Any, int]]]:
    """Return the messages of each topic with the time of their recording [ns]."""
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(f"{path}: reading bags needs an extra: pip install 'fricmodels[ros]'") from None
    topics: dict[str, list[tuple[Any, int]]] = {}
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as reader:
            wanted = [c for c in reader.connections if c.msgtype.split("/")[-1] == "JointState"]
            others = sorted({c.msgtype for c in reader.connections})
            for connection, recorded, data in reader.messages(connections=wanted) if wanted else ():
                message = reader.deserialize(data, connection.msgtype)
                topics.setdefault(connection.topic, []).append((message, recorded))
    except Exception as error:
        raise InputError(f"{path}: cannot be read as a bag: {' '.join(str(error).split())}") from None
    if not topics:
        held = ", ".join(others) or "nothing else either"
        raise InputError(f"{path}: has no messages of type sensor_msgs/JointState, but {held}")
    return topics


def _row(message: Any, recorded: int) -> dict[str, float]:
    stamp = message.header.stamp
    nanoseconds = stamp.sec * 10**9 + stamp.nanosec
    row: dict[str, float] = {"stamp": nanoseconds or recorded}
    for quantity in _QUANTITIES:
        values = np.asarray(getattr(message, quantity), dtype=float)
        if len(values) == len(message.name):
            row.update((f"{joint}.{quantity}", value) for joint, value in zip(message.name, values, strict=True))
    return row
