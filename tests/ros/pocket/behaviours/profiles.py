# %% a profile whose depth is ignored
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    QoSProfile(depth=0)
    QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=0)
print([str(warning.message) for warning in said])

# %% old names of policies
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    print(DurabilityPolicy.RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL)
    print(HistoryPolicy.RMW_QOS_POLICY_HISTORY_KEEP_ALL is HistoryPolicy.KEEP_ALL)
    print(LivelinessPolicy.RMW_QOS_POLICY_DURABILITY_UNKNOWN.name)
    print(QoSProfile(depth=1, reliability=QoSReliabilityPolicy.RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT).reliability.name)
for warning in said:
    print(warning.category.__name__, warning.message)
