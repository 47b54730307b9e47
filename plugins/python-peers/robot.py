"""A robot: it brings what a master assigns to it, and waits at its charger. It enters no block that another one wants."""
import sys

from robots import Robot

url, schemas, number = sys.argv[1:]
robot = Robot(url, schemas, int(number))


def toward(goal):
    at = robot.at
    axis = "x" if at["x"] != goal["x"] else "y"
    return {**at, axis: at[axis] + (goal[axis] > at[axis]) - (goal[axis] < at[axis])}


def goal():
    if robot.job is None:
        return robot.charger
    return robot.job["to" if robot.carries else "from"]


while not robot.is_over():
    robot.hear()
    if robot.job and robot.at == goal():
        if robot.carries:
            robot.deliver()
        else:
            robot.carries = True
    if not robot.enter():
        robot.want(toward(goal()))
robot.end()
