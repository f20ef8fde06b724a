# %% defaults
for type_ in (String, Int32, Float32, Bool, Header, ColorRGBA, Empty, Vector3):
    print(type_())

# %% a message within a message is the one given
point = Point(x=1.0)
pose = Pose(position=point)
point.y = 2.0
print(pose.position is point, pose.position.y)

# %% every message has its own parts
a, b = Twist(), Twist()
a.linear.x = 1.0
print(b.linear.x, a.linear is b.linear)

# %% a list of names is the one given
names = ["a"]
m = JointState(name=names)
names.append("b")
print(m.name)

# %% the array of a message is its own
values = [1.0]
m = JointState(position=values)
values.append(2.0)
m.position.append(3.0)
print(m.position)

# %% a covariance of eight when it is set
m = Imu()
m.orientation_covariance = [0.0] * 8
print(len(m.orientation_covariance))

# %% a covariance that is an array
m = Imu()
m.orientation_covariance = numpy.arange(9.0)
print(m.orientation_covariance.sum())

# %% nothing as an array
m = JointState()
m.position = None

# %% a field that there is not
m = String()
m.text = "x"

# %% numbers that are checked
for type_, value in ((Int8, 200), (UInt8, -1), (Int32, 1.0), (Int32, 2**31), (Float32, 1), (Float32, 1e39), (Bool, 1)):
    attempt(type_, data=value, check_fields=True)

# %% a checked message stays checked
m = Int32(check_fields=True)
attempt(setattr, m, "data", "x")
print(m.data)

# %% copies of messages
m = JointState(name=["a"], position=[1.0])
shallow, deep = copy(m), deepcopy(m)
m.name.append("b")
m.position.append(2.0)
print(shallow.name, list(shallow.position), deep.name, list(deep.position), deep == m)

# %% fields of messages
for type_ in (Imu, Image, ColorRGBA, Empty, ByteMultiArray):
    print(type_.get_fields_and_field_types())

# %% a message's fields can be changed as a copy only
types = Joy.get_fields_and_field_types()
types.clear()
print(len(Joy.get_fields_and_field_types()))

# %% constants
from sensor_msgs.msg import BatteryState, NavSatStatus

print(NavSatStatus.STATUS_FIX, NavSatStatus.STATUS_NO_FIX, BatteryState.POWER_SUPPLY_STATUS_FULL)

# %% constants cannot be changed
from sensor_msgs.msg import NavSatStatus

NavSatStatus.STATUS_FIX = 3

# %% packages that there are not
import nowhere_msgs.msg

# %% messages that there are not
from std_msgs.msg import Joystick

# %% serialised messages
for message in (String(data="x"), Int32(data=-2), Vector3(x=1.0), Joy(header=Header(frame_id="abc"), axes=[0.5])):
    data = serialize_message(message)
    print(data.hex(), deserialize_message(data, type(message)) == message)

# %% an image's bytes
m = Image(data=b"\x01\x02")
print(m.data, type(m.data).__name__)
m.data = [3, 4]
print(m.data)
