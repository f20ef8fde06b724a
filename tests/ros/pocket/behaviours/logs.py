# %% every severity
logger = logging.get_logger("every")
logger.set_level(logging.LoggingSeverity.DEBUG)
print([log("text") for log in (logger.debug, logger.info, logger.warn, logger.warning, logger.error, logger.fatal)])

# %% a level drops lower severities
logger = logging.get_logger("drops")
logger.set_level(logging.LoggingSeverity.ERROR)
print(logger.info("hidden"), logger.warning("hidden"), logger.error("shown"), logger.fatal("shown"))

# %% a line only once
logger = logging.get_logger("once")
print([logger.info(f"line {number}", once=True) for number in range(3)])

# %% a line skipped the first time
logger = logging.get_logger("skipped")
print([logger.info(f"line {number}", skip_first=True) for number in range(3)])

# %% a throttled line
logger = logging.get_logger("throttled")
print([logger.info(f"line {number}", throttle_duration_sec=1e9) for number in range(3)])

# %% a line skipped the first time, then once
logger = logging.get_logger("both")
print([logger.info(f"line {number}", skip_first=True, once=True) for number in range(4)])

# %% two lines, each once
logger = logging.get_logger("lines")
for _ in range(2):
    logger.info("one", once=True)
    logger.info("two", once=True)

# %% a hidden line does not count
logger = logging.get_logger("counted")
for level in (40, 20):
    logger.set_level(level)
    print(logger.info(f"at {level}", once=True))

# %% options set to False
logger = logging.get_logger("no")
print([logger.info(f"line {number}", once=False, skip_first=False) for number in range(2)])

# %% changing severities
logger = logging.get_logger("changes")


def log(severity, **options):
    return logger.log("text", severity, **options)


print(log(20))
attempt(log, 30)
attempt(log, 20, name="other")

# %% changing filters
logger = logging.get_logger("filters")


def log(**options):
    return logger.info("text", **options)


print(log())
attempt(log, once=True)

# %% log() takes a severity
logger = logging.get_logger("log")
print(logger.log("one", logging.LoggingSeverity.WARN), logger.log("two", 40), logger.log("three", 10))

# %% texts with percent signs, braces and lines
logger = logging.get_logger("texts")
logger.info("100 % %s {0} {}")
logger.info("")
logger.info("ä → ü")

# %% a name for one line
logging.get_logger("mine").info("text", name="other")

# %% a node's logger
n = start(namespace="/Tank")
n.get_logger().info("text")
n.get_logger().get_child("part").warning("text")

# %% loggers before and after a start
print(logging.get_logger("early").info("before"))
rclpy.init(args=[])
rclpy.shutdown()
print(logging.get_logger("late").info("after"))
