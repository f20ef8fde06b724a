from rcl_interfaces.msg import ParameterEvent, SetParametersResult

n = start()


# %% callbacks before, during and after a change
def names(parameters):
    return [(parameter.name, parameter.value) for parameter in parameters]


def before(parameters):
    print("before", names(parameters))
    return [*parameters, Parameter("b", value=parameters[0].value + 1)]


def check(parameters):
    print("at", names(parameters), n.get_parameter_or("a").value)
    return SetParametersResult(successful=all(parameter.value < 10 for parameter in parameters), reason="too large")


def after(parameters):
    print("after", names(parameters), n.get_parameter_or("a").value)


n.add_pre_set_parameters_callback(before)
n.add_on_set_parameters_callback(check)
n.add_post_set_parameters_callback(after)
n.declare_parameters("", [("a", 1), ("b", 2)])
attempt(n.declare_parameter, "c", 11)
print(n.has_parameter("c"))
print(n.set_parameters([Parameter("a", value=3), Parameter("a", value=9)]), n.get_parameter("a").value)
print(n.set_parameters_atomically([Parameter("a", value=5)]), n.get_parameter("b").value)
n.remove_pre_set_parameters_callback(before)
n.remove_post_set_parameters_callback(after)
n.undeclare_parameter("b")
print(n.set_parameters([Parameter("a", value=6)]))


# %% the callback added last runs first, and the first refusal counts
def check(number, parameters):
    print(number)
    return SetParametersResult(successful=number != 2, reason=f"number {number}")


for number in range(4):
    n.add_on_set_parameters_callback(partial(check, number))
    n.add_post_set_parameters_callback(lambda parameters, number=number: print("after", number))
attempt(n.declare_parameter, "a", 1)

# %% a callback that removes all parameters
n.declare_parameter("a", 1)
n.add_pre_set_parameters_callback(lambda parameters: [])
print(n.set_parameters([Parameter("a", value=2)]), n.set_parameters_atomically([Parameter("a", value=2)]))
print(n.get_parameter("a").value)

# %% a callback that raises or returns nothing
n.declare_parameter("a", 1)
n.add_on_set_parameters_callback(lambda parameters: None)
print(raised(n.set_parameters, [Parameter("a", value=2)]), n.get_parameter("a").value)
n.add_on_set_parameters_callback(lambda parameters: 1 / 0)
print(raised(n.set_parameters, [Parameter("a", value=2)]), n.get_parameter("a").value)
n.add_pre_set_parameters_callback(lambda parameters: None)
print(raised(n.set_parameters, [Parameter("a", value=2)]))

# %% changes are published
events = []
m = rclpy.create_node("listener")
m.create_subscription(ParameterEvent, "/parameter_events", events.append, 100)
(publisher,) = n.publishers
wait(m, publisher.get_subscription_count)
n.declare_parameter("a", 1)
n.set_parameters([Parameter("a", value=2)])
n.declare_parameters(
    "", [("b", "x"), ("c", Parameter.Type.INTEGER), ("d", None, ParameterDescriptor(dynamic_typing=True))]
)
n.set_parameters([Parameter("c", value=5), Parameter("d", value=[1.5]), Parameter("d")])
n.set_parameters_atomically([Parameter("a", value=3), Parameter("b", value="y")])
n.undeclare_parameter("b")
n.set_parameters([Parameter("a", value="refused"), Parameter("a", value=4)])
wait(m, lambda: len(events) == 10)
for event in events:
    changes = (event.new_parameters, event.changed_parameters, event.deleted_parameters)
    print(event.node, event.stamp.sec > 10**9, *([(p.name, p.value.type) for p in each] for each in changes))
