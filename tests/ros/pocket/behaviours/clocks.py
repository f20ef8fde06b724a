n = start("-p", "use_sim_time:=true")
clock, slept = n.get_clock(), []


def sleep_until(seconds):
    """Sleep on a new thread, and return that thread."""
    until = Time(seconds=seconds, clock_type=ClockType.ROS_TIME)
    thread = threading.Thread(target=lambda: slept.append(clock.sleep_until(until)))
    thread.start()
    threading.Event().wait(0.2)
    return thread


# %% a sleep until a simulated time
sleeper = sleep_until(5)
clock.set_ros_time_override(Time(seconds=4))
threading.Event().wait(0.2)
print(slept)
clock.set_ros_time_override(Time(seconds=7))
sleeper.join(30)
print(slept)

# %% a sleep ends when the clock is switched
sleeper = sleep_until(5)
n.set_parameters([Parameter("use_sim_time", value=False)])
sleeper.join(30)
print(slept)

# %% a sleep in simulated time ends at a shutdown
sleeper = sleep_until(5)
rclpy.shutdown()
sleeper.join(30)
print(slept)
