# %% a profile whose depth does not matter
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    QoSProfile(depth=0)
    QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=0)
print([str(warning.message) for warning in said])
