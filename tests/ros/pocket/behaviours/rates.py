n = start()
thread = threading.Thread(target=raised, args=(rclpy.spin, n))

# %% a loop at a rate
import time

rate = n.create_rate(100)
thread.start()
began = time.monotonic()
for _ in range(20):
    rate.sleep()
print(0.15 < time.monotonic() - began < 10, n.destroy_rate(rate))
attempt(rate.sleep)
rclpy.shutdown()
thread.join(30)

# %% destroying a rate wakes up its sleeper, with and without a timer
slow = n.create_rate(0.001)
sleeper = threading.Thread(target=attempt, args=(slow.sleep,))
sleeper.start()
threading.Event().wait(0.2)
slow.destroy()
sleeper.join(30)
print(sleeper.is_alive())

# %% a shutdown wakes up a sleeper
slow = n.create_rate(0.001)
sleeper = threading.Thread(target=attempt, args=(slow.sleep,))
sleeper.start()
threading.Event().wait(0.2)
rclpy.shutdown()
sleeper.join(30)
print(sleeper.is_alive())
attempt(slow.sleep)

# %% a rate of simulated time
n.set_parameters([Parameter("use_sim_time", value=True)])
clock = n.get_clock()
clock.set_ros_time_override(Time(seconds=1))
rate, turns = n.create_rate(1), []
sleeper = threading.Thread(target=lambda: [turns.append(rate.sleep()) for _ in range(2)])
sleeper.start()
for second in (2, 3):
    threading.Event().wait(0.2)
    print(len(turns))
    clock.set_ros_time_override(Time(seconds=second))
    wait(n, lambda second=second: len(turns) == second - 1)
sleeper.join(30)
print(len(turns), sleeper.is_alive())
