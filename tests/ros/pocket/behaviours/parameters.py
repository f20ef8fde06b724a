n = start()

# %% a declared parameter
p = n.declare_parameter("a", 1)
print(type(p).__name__, p.name, p.value, p.type_, n.get_parameter("a") is p, n.has_parameter("a"))

# %% types follow from values
for index, value in enumerate((True, 1, 1.0, "x", [True], [1], [1.0], ["x"], [b"x"])):
    print(n.declare_parameter(f"p{index}", value).type_.name)

# %% tuples and empty lists as values
for index, value in enumerate(((1, 2), [], ())):
    p = n.declare_parameter(f"p{index}", value)
    print(p.type_.name, p.value)

# %% values that no parameter has
for index, value in enumerate(({}, {1}, object, [1, "x"], [None], 1j)):
    attempt(n.declare_parameter, f"p{index}", value)

# %% a parameter declared twice
n.declare_parameter("a", 1)
n.declare_parameter("a", 1)

# %% names of parameters
attempt(n.declare_parameter, "", 1)
attempt(n.declare_parameter, 3, 1)
print(n.declare_parameter("a.b/c d", 1).name)

# %% a parameter that is not there
attempt(n.get_parameter, "a")
try:
    n.set_parameters([Parameter("a", value=1)])
except ParameterNotDeclaredException as error:
    print(type(error).__name__)
print(n.has_parameter("a"))

# %% something instead of a parameter that is there
n.declare_parameter("a", 1)
print(n.get_parameter_or("a", Parameter("b", value=3)).value)

# %% several parameters are set
n.declare_parameter("a", 1)
n.declare_parameter("b", "x")
results = n.set_parameters([Parameter("a", value="no"), Parameter("b", value="y")])
print([result.successful for result in results], n.get_parameter("a").value, n.get_parameter("b").value)

# %% of what is set, what comes before an error stays
n.declare_parameter("a", 1)
try:
    n.set_parameters([Parameter("a", value=2), Parameter("b", value=2)])
except ParameterNotDeclaredException as error:
    print(type(error).__name__)
print(n.get_parameter("a").value)

# %% a parameter of a type without a value
p = n.declare_parameter("a", Parameter.Type.INTEGER)
print(p.value, p.type_.name, n.has_parameter("a"))
attempt(n.get_parameter, "a")
print(n.set_parameters([Parameter("a", value=2)])[0].successful, n.get_parameter("a").value)

# %% a read-only parameter
n.declare_parameter("a", 1, ParameterDescriptor(read_only=True))
print(n.set_parameters([Parameter("a", value=2)])[0], n.get_parameter("a").value)

# %% a range of integers
limits = IntegerRange(from_value=0, to_value=10, step=2)
n.declare_parameter("a", 4, ParameterDescriptor(integer_range=[limits]))
for value in (6, 0, 10, 5, 11, -1):
    print(n.set_parameters([Parameter("a", value=value)])[0])

# %% a range of integers without steps
n.declare_parameter("a", 4, ParameterDescriptor(integer_range=[IntegerRange(from_value=0, to_value=10)]))
print([n.set_parameters([Parameter("a", value=value)])[0].successful for value in (5, 11)])

# %% a range of numbers
limits = FloatingPointRange(from_value=0.0, to_value=1.0, step=0.25)
n.declare_parameter("a", 0.5, ParameterDescriptor(floating_point_range=[limits]))
for value in (0.75, 1.0, 0.3, 1.5, -0.5):
    print(n.set_parameters([Parameter("a", value=value)])[0])

# %% a parameter's constructor
for arguments in ({"value": 1}, {"type_": Parameter.Type.DOUBLE, "value": 1.0}, {"type_": Parameter.Type.NOT_SET}, {}):
    p = Parameter("a", **arguments)
    print(p.name, p.type_.name, p.value)

# %% a parameter cannot be changed
p = Parameter("a", value=1)
for part in ("name", "value", "type_"):
    try:
        setattr(p, part, 3)
    except AttributeError:
        print("cannot set", part)

# %% types of parameters
for type_ in Parameter.Type:
    print(type_, type_.value)

# %% types of values
for value in (None, True, 1, 1.5, "x", b"x", [], [b"x"], [1, True], [1.0, 2]):
    attempt(Parameter.Type.from_parameter_value, value)

# %% overrides of the program
n = start(parameter_overrides=[Parameter("a", value=5), Parameter("b", value="x")])
print(n.declare_parameter("a", 1).value, n.has_parameter("b"))
attempt(n.declare_parameter, "b", 1)

# %% no value, no type
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    p = n.declare_parameter("a")
print(p.type_.name, n.get_parameter("a").value, said[0].category.__name__, str(said[0].message).splitlines()[0])

# %% no value, but a type that may change
p = n.declare_parameter("a", descriptor=ParameterDescriptor(dynamic_typing=True))
print(p.value, n.get_parameter("a").type_.name)

# %% errors of parameters have a common base
try:
    n.get_parameter("a")
except ParameterException as error:
    print(type(error).__name__, type(error).__mro__[1].__name__)

# %% parameters of two nodes
n, m = start(), rclpy.create_node("u")
n.declare_parameter("a", 1)
print(n.has_parameter("a"), m.has_parameter("a"))
