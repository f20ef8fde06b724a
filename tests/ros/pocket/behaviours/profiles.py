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

# %% settings of the wrong type
for setting in ("depth", "history", "reliability", "durability", "liveliness"):
    attempt(QoSProfile, **{"depth": 1, setting: "x"})
for setting in ("deadline", "lifespan", "liveliness_lease_duration", "avoid_ros_namespace_conventions"):
    attempt(QoSProfile, **{"depth": 1, setting: 1})

# %% a profile is changed
profile = QoSProfile(depth=1)
profile.depth = 5
profile.reliability = ReliabilityPolicy.BEST_EFFORT
attempt(setattr, profile, "depth", "x")
attempt(setattr, profile, "colour", "red")
print(profile.depth, profile.reliability.name)

# %% predefined profiles
for name in ("sensor_data", "system_default", "services_default", "parameters", "parameter_events"):
    print(name, globals()[f"qos_profile_{name}"])

# %% predefined profiles by name
for preset in QoSPresetProfiles:
    print(preset.name, preset.value.depth, preset.value.reliability.name)

# %% short keys of policies
for policy in (HistoryPolicy, ReliabilityPolicy, DurabilityPolicy, LivelinessPolicy):
    print(policy.short_keys())

# %% members of policies
for policy in (HistoryPolicy, ReliabilityPolicy, DurabilityPolicy, LivelinessPolicy):
    print([(member.name, member.value) for member in policy])

# %% a profile whose depth does not matter
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    QoSProfile(depth=0)
    QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=0)
print([str(warning.message) for warning in said])
