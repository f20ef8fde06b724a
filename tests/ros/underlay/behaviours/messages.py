# %% defaults
for type_ in (String, Int32, Float32, Bool, Header, ColorRGBA, Empty, Vector3):
    print(type_())

# %% defaults of bytes
print(ByteMultiArray())

# %% defaults that are not zero
print(Quaternion(), NavSatFix().status.status)

# %% messages within messages
print(Pose(position=Point(x=1.0)))

# %% a message within a message is the one given
point = Point(x=1.0)
pose = Pose(position=point)
point.y = 2.0
print(pose.position is point, pose.position.y)

# %% every message has its own parts
a, b = Twist(), Twist()
a.linear.x = 1.0
print(b.linear.x, a.linear is b.linear)

# %% a list is kept as an array
m = JointState(position=[1, 2])
print(m.position, type(m.position).__name__, m.position.typecode)

# %% a tuple and a range become arrays
print(JointState(position=(1.0, 2.0)).position, JointState(position=range(3)).position)

# %% a numpy array becomes an array
m = JointState(position=numpy.array([1.0, 2.0]))
print(m.position, type(m.position).__name__)

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

# %% a covariance
m = Imu(orientation_covariance=[1.0] * 9)
print(m.orientation_covariance, m.orientation_covariance.dtype, len(m.orientation_covariance))

# %% a covariance of eight when the message is made
Imu(orientation_covariance=[0.0] * 8)

# %% a covariance of eight when it is set
m = Imu()
m.orientation_covariance = [0.0] * 8
print(len(m.orientation_covariance))

# %% a covariance that is an array
m = Imu()
m.orientation_covariance = numpy.arange(9.0)
print(m.orientation_covariance.sum())

# %% words in an array
JointState(position=["a"])

# %% a number as an array
JointState(position=1.0)

# %% nothing as an array
m = JointState()
m.position = None

# %% a field that there is not
m = String()
m.text = "x"

# %% a field that there is not is read
String().text

# %% values are not checked
m = Int32(data="x")
print(m)

# %% numbers that are checked
for type_, value in ((Int8, 200), (UInt8, -1), (Int32, 1.0), (Int32, 2**31), (Float32, 1), (Float32, 1e39), (Bool, 1)):
    attempt(type_, data=value, check_fields=True)

# %% texts that are checked
attempt(String, data=3, check_fields=True)
attempt(String, data=b"x", check_fields=True)
attempt(String, data=None, check_fields=True)

# %% checked numbers that pass
print(Int8(data=-128, check_fields=True), Float32(data=math.inf, check_fields=True), Bool(data=True, check_fields=True))

# %% checked parts
attempt(Pose, position=Vector3(), check_fields=True)
attempt(Header, stamp=3, check_fields=True)

# %% checked sequences
attempt(JointState, name="ab", check_fields=True)
attempt(JointState, name=[1], check_fields=True)
attempt(JointState, name=["a"], position=[1.0], check_fields=True)

# %% checked fields that there are not
String(text="x", check_fields=True)

# %% a checked message stays checked
m = Int32(check_fields=True)
attempt(setattr, m, "data", "x")
print(m.data)

# %% equal messages
print(String(data="a") == String(data="a"), String() == "", Int32() == UInt8(), Header() == Header())
print(
    JointState(position=[1.0]) == JointState(position=[1.0]),
    Imu() == Imu(),
    Imu() != Imu(linear_acceleration=Vector3(x=1.0)),
)

# %% not a number is not equal
print(Float32(data=math.nan) == Float32(data=math.nan))

# %% messages have no hash
hash(String())

# %% copies of messages
m = JointState(name=["a"], position=[1.0])
shallow, deep = copy(m), deepcopy(m)
m.name.append("b")
m.position.append(2.0)
print(shallow.name, list(shallow.position), deep.name, list(deep.position), deep == m)

# %% messages as texts
print(str(Bool(data=True)), repr(String(data="it's")), [Int32(data=1)])

# %% a message with numbers as a text
print(JointState(name=["a"], position=[1.0, 2.5]))

# %% a message with an array as a text
print(Imu(orientation_covariance=[0.5] * 9))

# %% fields of messages
for type_ in (Imu, Image, ColorRGBA, Empty, ByteMultiArray):
    print(type_.get_fields_and_field_types())

# %% slots of messages
print(Twist.__slots__, Empty.__slots__, Header.__slots__)

# %% a message's fields can be changed as a copy only
types = Joy.get_fields_and_field_types()
types.clear()
print(len(Joy.get_fields_and_field_types()))

# %% where messages come from
print(Joy.__module__, Joy.__name__, type(Joy()).__qualname__)

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

# %% bytes that are no message
attempt(lambda: type(deserialize_message(serialize_message(Int32(data=5)), Int32)).__name__)
attempt(deserialize_message, serialize_message(String()), int)

# %% what has no bytes
attempt(serialize_message, None)
attempt(serialize_message, "x")

# %% an image's bytes
m = Image(data=b"\x01\x02")
print(m.data, type(m.data).__name__)
m.data = [3, 4]
print(m.data)

# %% a list of bytes
m = ByteMultiArray(data=[b"a", b"b"])
print(m.data, deserialize_message(serialize_message(m), ByteMultiArray).data)

# %% texts in any language
print(deserialize_message(serialize_message(String(data="Grüße, 世界")), String).data)

# %% numbers are rounded on the way
print(deserialize_message(serialize_message(Float32(data=0.1)), Float32).data)
