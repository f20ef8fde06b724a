# %% names are resolved
n = start(namespace="/Tank")
for name in ("x", "/x", "a/b", "~", "~/x", "{node}", "/{ns}/x", "{namespace}/x", "x{node}"):
    attempt(n.resolve_topic_name, name)

# %% names that cannot be resolved
n = start()
for name in ("", "bad name", "x/", "/", "a//b", "1x", "a/1", "~x", "a~", "{what}", "{node", "x-y", "/x/{ns}"):
    attempt(n.resolve_topic_name, name)

# %% names of topics
for name in ("x", "/x", "~/x", "{node}/x", "a_1", "_", "x__y", "a/b/c"):
    print(validate_topic_name(name))

# %% bad names of topics
for name in ("", "x y", "9", "a/9", "x/", "{a", "a}", "{1}", "~a", "a~b", "a-b", "ä", "{a b}"):
    attempt(validate_topic_name, name)

# %% bad full names of topics
for name in ("", "x", "/", "/x/", "/a//b", "/9", "/~", "/{node}", "/a b"):
    attempt(validate_full_topic_name, name)

# %% names of nodes
for name in ("a", "A1", "_x", "a" * 255):
    print(validate_node_name(name))

# %% bad names of nodes
for name in ("", "1a", "a b", "a/b", "a-b", "~", "ü", "a" * 256):
    attempt(validate_node_name, name)

# %% namespaces
for name in ("/", "/a", "/a/b", "/_"):
    print(validate_namespace(name))

# %% bad namespaces
for name in ("", "a", "/a/", "//", "/a//b", "/1", "/a b", "/~"):
    attempt(validate_namespace, name)

# %% names are expanded
for name in ("x", "/x", "~", "~/x", "{node}/x", "{ns}/x", "{namespace}/x"):
    print(expand_topic_name(name, "t", "/Tank"), expand_topic_name(name, "t", "/"))

# %% names are strings
n = start()
try:
    n.create_publisher(String, 3, 1)
except Exception as error:
    print(type(error).__name__)

# %% a node's name is a string
rclpy.init(args=[])
try:
    rclpy.create_node(3)
except Exception as error:
    print(type(error).__name__)

# %% errors of names have a common base
try:
    validate_topic_name("bad name")
except NameValidationException as error:
    print(type(error).__name__, isinstance(error, ValueError))
