# %% defaults
for type_ in (String, Int32, Float32, Bool, Header, ColorRGBA, Empty, Vector3):
    print(type_())

# %% a message within a message is the one given
point = Point(x=1.0)
pose = Pose(position=point)
point.y = 2.0
print(pose.position is point, pose.position.y)

# %% copies of messages
m = JointState(name=["a"], position=[1.0])
shallow, deep = copy(m), deepcopy(m)
m.name.append("b")
m.position.append(2.0)
print(shallow.name, list(shallow.position), deep.name, list(deep.position), deep == m)

# %% a message's fields can be changed as a copy only
types = Joy.get_fields_and_field_types()
types.clear()
print(len(Joy.get_fields_and_field_types()))

# %% packages that there are not
import nowhere_msgs.msg
