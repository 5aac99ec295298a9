import numpy as np
import pytest

from fricmodels.errors import InputError
from fricmodels.readers import read

rosbags = pytest.importorskip("rosbags.rosbag2", reason="the extra 'ros' is not installed")

MAPPING = ["torque=elbow.effort", "velocity=elbow.velocity", "position=elbow.position"]


def write(directory, plugin, topics=("/joint_states",), type_name="sensor_msgs/msg/JointState"):
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    kinds = store.types
    with rosbags.Writer(directory / "bag", version=9, storage_plugin=plugin) as writer:
        for topic in topics:
            connection = writer.add_connection(topic, type_name, typestore=store)
            for i in range(50):
                recorded = 1_700_000_000_000_000_000 + 10_000_000 * i
                stamp = kinds["builtin_interfaces/msg/Time"](sec=recorded // 10**9, nanosec=recorded % 10**9)
                header = kinds["std_msgs/msg/Header"](stamp=stamp, frame_id="")
                if type_name.endswith("JointState"):
                    message = kinds[type_name](
                        header=header,
                        name=["shoulder", "elbow"],
                        position=np.array([0.0, np.sin(0.1 * i)]),
                        velocity=np.array([0.0, np.cos(0.1 * i)]),
                        effort=np.array([1.0, 0.5 * i]),
                    )
                else:
                    message = header
                writer.write(connection, recorded + 123, store.serialize_cdr(message, type_name))
    return next(path for path in (directory / "bag").iterdir() if path.suffix in (".mcap", ".db3"))


@pytest.mark.parametrize("plugin", list(rosbags.StoragePlugin))
def test_joint_states(tmp_path, plugin):
    recording = read(write(tmp_path, plugin), columns=MAPPING)
    i = np.arange(50)
    np.testing.assert_allclose(recording.time, 0.01 * i, atol=1e-9)
    np.testing.assert_allclose(recording.torque, 0.5 * i)
    np.testing.assert_allclose(recording["position"], np.sin(0.1 * i))
    np.testing.assert_allclose(recording.velocity, np.cos(0.1 * i))


def test_each_topic_is_a_run(tmp_path):
    path = write(tmp_path, rosbags.StoragePlugin.MCAP, ("/left", "/right"))
    recording = read(path, columns=MAPPING)
    assert sorted(recording.provenance["runs"].values()) == ["/left", "/right"]
    assert len(recording) == 100


def test_bags_without_joint_states(tmp_path):
    path = write(tmp_path, rosbags.StoragePlugin.MCAP, type_name="std_msgs/msg/Header")
    with pytest.raises(InputError, match="no messages of type sensor_msgs/JointState, but std_msgs/msg/Header"):
        read(path)
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(b"nothing of the kind")
    with pytest.raises(InputError, match="cannot be read as a bag"):
        read(broken)
