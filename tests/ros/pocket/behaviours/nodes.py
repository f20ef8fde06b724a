# %% a node without rosout
n = start(enable_rosout=False)
topics = []
while not topics:
    with suppress(RuntimeError):  # the node does not know of itself yet
        topics = [topic for topic, _ in n.get_publisher_names_and_types_by_node("t", "/")]
print(topics)
