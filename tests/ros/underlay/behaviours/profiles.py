# %% a profile's defaults
print(QoSProfile(depth=10))

# %% all settings of a profile
print(
    QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=3,
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        lifespan=Duration(seconds=1),
        deadline=Duration(seconds=2),
        liveliness=LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=Duration(seconds=3),
        avoid_ros_namespace_conventions=True,
    )
)

# %% everything is kept
print(QoSProfile(history=HistoryPolicy.KEEP_ALL))

# %% profiles that are none
attempt(QoSProfile)
attempt(QoSProfile, history=HistoryPolicy.KEEP_LAST)
attempt(QoSProfile, reliability=ReliabilityPolicy.RELIABLE)
attempt(QoSProfile, 10)

# %% settings that there are not
attempt(QoSProfile, depth=1, colour="red")

# %% settings of the wrong type
for setting in ("depth", "history", "reliability", "durability", "liveliness"):
    attempt(QoSProfile, **{"depth": 1, setting: "x"})
for setting in ("deadline", "lifespan", "liveliness_lease_duration", "avoid_ros_namespace_conventions"):
    attempt(QoSProfile, **{"depth": 1, setting: 1})

# %% numbers stand for policies
profile = QoSProfile(depth=1, reliability=2, durability=1)
print(profile.reliability.name, profile.durability.name, type(profile.reliability).__name__)

# %% numbers that stand for none
attempt(QoSProfile, depth=1, reliability=17)

# %% a depth below zero
print(QoSProfile(depth=-1).depth)

# %% a profile is changed
profile = QoSProfile(depth=1)
profile.depth = 5
profile.reliability = ReliabilityPolicy.BEST_EFFORT
attempt(setattr, profile, "depth", "x")
attempt(setattr, profile, "colour", "red")
print(profile.depth, profile.reliability.name)

# %% equal profiles
print(QoSProfile(depth=1) == QoSProfile(depth=1), QoSProfile(depth=1) != QoSProfile(depth=2))
print(QoSProfile(depth=1) == 1, QoSProfile(depth=1) == QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE))
print(QoSProfile(depth=1) == QoSProfile(depth=1, deadline=Duration(seconds=1)))

# %% profiles have no hash
attempt(hash, QoSProfile(depth=1))

# %% predefined profiles
for name in ("sensor_data", "system_default", "services_default", "parameters", "parameter_events"):
    print(name, globals()[f"qos_profile_{name}"])

# %% the profile of nothing known
print(qos_profile_unknown)

# %% the best profile available
print(qos_profile_best_available)

# %% the profile of actions
print(qos_profile_action_status_default)

# %% predefined profiles by name
for preset in QoSPresetProfiles:
    print(preset.name, preset.value.depth, preset.value.reliability.name)

# %% short keys of predefined profiles
print(QoSPresetProfiles.short_keys())
print(QoSPresetProfiles.get_from_short_key("sensor_data") == qos_profile_sensor_data)

# %% a predefined profile that there is not
attempt(QoSPresetProfiles.get_from_short_key, "loud")

# %% short keys of policies
for policy in (HistoryPolicy, ReliabilityPolicy, DurabilityPolicy, LivelinessPolicy):
    print(policy.short_keys())

# %% a policy by its short key
print(ReliabilityPolicy.get_from_short_key("best_effort"), DurabilityPolicy.get_from_short_key("Volatile"))
attempt(ReliabilityPolicy.get_from_short_key, "loud")

# %% a short key of a policy
print(HistoryPolicy.KEEP_ALL.short_key, LivelinessPolicy.MANUAL_BY_TOPIC.short_key)

# %% policies as texts
print(repr(ReliabilityPolicy.RELIABLE), str(DurabilityPolicy.VOLATILE), f"{HistoryPolicy.KEEP_LAST}")

# %% policies and their other names
print(
    QoSReliabilityPolicy is ReliabilityPolicy,
    QoSDurabilityPolicy is DurabilityPolicy,
    QoSHistoryPolicy is HistoryPolicy,
)

# %% members of policies
for policy in (HistoryPolicy, ReliabilityPolicy, DurabilityPolicy, LivelinessPolicy):
    print([(member.name, member.value) for member in policy])

# %% a profile whose depth does not matter
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    QoSProfile(depth=0)
    QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=0)
print([str(warning.message) for warning in said])

# %% a profile in the graph
n = start()
n.create_publisher(
    String,
    "x",
    QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT, durability=DurabilityPolicy.TRANSIENT_LOCAL),
)
while not n.get_publishers_info_by_topic("x"):
    pass
profile = n.get_publishers_info_by_topic("x")[0].qos_profile
print(profile.reliability.name, profile.durability.name, profile.liveliness.name, profile.deadline, profile.lifespan)

# %% what the graph tells of an endpoint
n = start(namespace="/Tank")
s = n.create_subscription(Joy, "joy", print, 1)
infos = []
while not infos or infos[0].node_name != "t":
    infos = n.get_subscriptions_info_by_topic("joy")
info = infos[0]
print(info.node_name, info.node_namespace, info.topic_type, info.endpoint_type.name, len(info.endpoint_gid))
print(info.topic_type_hash)
